"""How often the 95 % intervals hold the truth on real cars, by what the model of them lacks.

    python tests/studies/coverage_by_cause.py --cars 6 --seed 1 [--cause "a_x bias"] [--weighed]

The cars of `ensemble`, each with a ramp, a coast and three stops, and with one cause of `causes`
drawn on top; car i is the same car for every cause. One table with the reference speed `v` and one
without. A stop is warned if `validate` has a warning on it, or on the pads or the ramp of its
table, with which its answer begins; "unwarned" is what a reader would believe. What is said of the
coast log is left out: three of ten cars have no resistance at all, and that is named. Errors are
those of the pad friction against the plant, over the valid samples. In two of five stops the pads
really changed apart, of the control, too: a warning of that is a right one. At last the silent
ones: stops that are valid, not warned of, and hold less than half. With ``--weighed`` the vehicle
file says that its mass is known to 0.5 %.
"""

import sys
import zlib
from collections import Counter
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import BrakeCalError
from calib.car.mass import WEIGHED
from calib.estimation.limits import DEFAULTS
from calib.estimation.validate import validate_one
from calib.fitting.fit import fit
from calib.logs.log import Log
from calib.table.table import Table
from tests.studies.causes import CAUSES
from tests.studies.ensemble import case
from tests.studies.study import AgainstTruth, arguments, carried_out, pair
from tests.support.reference_car import without


@dataclass(frozen=True)
class Row:
    """One stop. ``held`` and ``squares``: number of valid samples that hold the truth, sum of the
    squared relative errors, front and rear; ``codes`` of the warnings on it and its table;
    ``refused`` if no estimate.
    """

    cause: str
    with_v: bool
    car: int = 0
    stop: str = ""
    valid: int = 0
    braked: int = 0
    held: np.ndarray = field(default_factory=lambda: np.zeros(2))
    squares: np.ndarray = field(default_factory=lambda: np.zeros(2))
    codes: tuple[str, ...] = ()
    refused: str = ""


def tried(job: tuple[str, int, int, bool]) -> list[Row]:
    """All stops of one car with one cause, by a table of its ramp and its coast: (cause, seed, car,
    weighed)."""
    cause, seed, number, weighed = job
    hidden = CAUSES[cause](np.random.default_rng([seed, number, zlib.crc32(cause.encode())]))
    of = case(np.random.default_rng([seed, number]), 3, 1000 * seed + number, hidden)
    car = replace(of.vehicle, mass_tolerance=WEIGHED) if weighed else of.vehicle
    runs = [log for log in (of.ramp, of.coast, *(stop.log for stop in of.stops)) if log]
    out = []
    for with_v in (True, False):
        ramp, coast, *stops = runs if with_v else [without(run, "v") for run in runs]
        try:
            table = fit(car, [ramp, coast])
        except BrakeCalError as error:
            out += [Row(cause, with_v, refused=f"fit: {error}") for _ in stops]
        else:
            out += [row(cause, with_v, number, table, stop) for stop in stops]
    return out


def row(cause: str, with_v: bool, car: int, table: Table, log: Log) -> Row:
    """One stop against the plant."""
    try:
        result = validate_one(table, log, None, DEFAULTS)
    except BrakeCalError as error:
        return Row(cause, with_v, refused=f"validate: {error}")
    e = result.estimate
    against = AgainstTruth.of(e, log)
    of_table = [warning for warning in table.warnings if warning.log != "coast"]
    return Row(
        cause,
        with_v,
        car,
        log.name,
        valid=int(np.sum(e.valid)),
        braked=int(np.sum(e.braked & (e.speed > 3.0))),
        held=against.held.sum(axis=1),
        squares=np.sum(against.error**2, axis=1),
        codes=tuple(warning.code for warning in (*of_table, *result.warnings)),
    )


def printed(found: list[Row], with_v: bool) -> None:
    """Print the table, one line for each cause."""
    print(f"\n{'with' if with_v else 'without'} v")
    print(f"{'cause':24} {'stops':>5} {'refused':>7} {'coverage f/r':>13} {'valid':>6} "
          f"{'rms f/r %':>12} {'warned':>7} {'unwarned f/r':>13}   codes")  # fmt: skip
    for cause in CAUSES:
        part = [r for r in found if (r.cause, r.with_v) == (cause, with_v)]
        answered = [r for r in part if not r.refused]
        if not answered:
            continue
        quiet = [r for r in answered if not r.codes]
        valid, braked = sum(r.valid for r in answered), sum(r.braked for r in answered)
        rms = 100 * np.sqrt(sum(r.squares for r in answered) / max(valid, 1))
        counted = Counter(code for r in answered for code in set(r.codes))
        codes = ", ".join(f"{code} {n}" for code, n in counted.most_common(3))
        print(f"{cause:24} {len(part):5} {len(part) - len(answered):7} {coverage(answered):>13} "
              f"{valid / max(braked, 1):6.2f} {pair(rms, '.1f'):>12} "
              f"{100 * (1 - len(quiet) / len(answered)):5.0f} % {coverage(quiet):>13}   "
              f"{codes}")  # fmt: skip
    for r in found:
        if r.with_v == with_v and r.valid and not r.codes and np.min(r.held) < 0.5 * r.valid:
            print(f"silent: {r.cause}, car {r.car}, {r.stop}: coverage {coverage([r])}, "
                  f"rms {pair(100 * np.sqrt(r.squares / r.valid), '.1f')} %")  # fmt: skip
    refusals = Counter(r.refused for r in found if r.refused and r.with_v == with_v)
    for text, n in refusals.most_common(5):
        print(f"refused {n}: {text[:160]}")


def coverage(part: list[Row]) -> str:
    """Share of valid samples whose interval holds the truth, front and rear."""
    valid = sum(r.valid for r in part)
    return pair(sum(r.held for r in part) / valid) if valid else "none"


def main() -> None:
    """Run the study."""
    asked = arguments(__doc__, "weighed", cars=6, seed=1, jobs=1, cause=list(CAUSES))
    jobs = [(c, asked.seed, i, asked.weighed) for c in asked.cause for i in range(asked.cars)]
    found = [row for part in carried_out(tried, jobs, asked.jobs) for row in part]
    for with_v in (True, False):
        printed(found, with_v)


if __name__ == "__main__":
    main()

"""How often the 95 % intervals hold the truth on real cars, by what the model of them lacks.

    python tests/studies/coverage_by_cause.py --cars 6 --seed 1 [--cause "a_x bias"] [--weighed]

The cars of `ensemble`, each with a ramp, a coast and three stops, and with one cause of `causes`
drawn on top; car i is the same car for every cause. One table with the reference speed `v` and one
without. A stop is warned if `validate` has a warning on it, or on the pads or the ramp of its
table, with which its answer begins; "unwarned" is what a reader would believe. What is said of the
coast log is left out: three of ten cars have no resistance at all, and that is named. Errors are
those of the pad friction against the plant, over the valid samples. In two of five stops the pads
really changed apart, of the control, too: a warning of that is a right one.
With ``--weighed`` the vehicle file says that its mass is known to 0.5 %.
"""

import argparse
import sys
import zlib
from collections import Counter
from collections.abc import Sequence
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
from tests.studies.against_truth import against_truth, truths_of
from tests.studies.causes import CAUSES
from tests.studies.coverage import without_v
from tests.studies.ensemble import Case, case
from tests.studies.pool import carried_out


@dataclass(frozen=True)
class Row:
    """One stop. ``held`` and ``squares``: number of valid samples that hold the truth, sum of the
    squared relative errors, front and rear; ``codes`` of the warnings on it and its table;
    ``refused`` if no estimate.
    """

    cause: str
    with_v: bool
    valid: int = 0
    braked: int = 0
    held: tuple[float, float] = (0.0, 0.0)
    squares: tuple[float, float] = (0.0, 0.0)
    codes: tuple[str, ...] = field(default=())
    refused: str = ""


def tried(job: tuple[str, int, int, bool]) -> list[Row]:
    """All stops of one car with one cause: (cause, seed, car, weighed)."""
    cause, seed, number, weighed = job
    hidden = CAUSES[cause](np.random.default_rng([seed, number, zlib.crc32(cause.encode())]))
    of = case(np.random.default_rng([seed, number]), 3, 1000 * seed + number, hidden)
    if weighed:
        of = replace(of, vehicle=replace(of.vehicle, mass_tolerance=WEIGHED))
    return [row for keep_v in (True, False) for row in rows(cause, of, keep_v)]


def rows(cause: str, of: Case, keep_v: bool) -> list[Row]:
    """The stops of a car, by a table of its ramp and its coast."""

    def seen(log: Log) -> Log:
        return log if keep_v else without_v(log)

    try:
        table = fit(of.vehicle, [seen(log) for log in (of.ramp, of.coast) if log])
    except BrakeCalError as error:
        return [Row(cause, keep_v, refused=f"fit: {error}") for _ in of.stops]
    return [row(cause, keep_v, table, seen(stop.log)) for stop in of.stops]


def row(cause: str, keep_v: bool, table: Table, log: Log) -> Row:
    """One stop against the plant."""
    try:
        result = validate_one(table, log, None, DEFAULTS, baselines=False)
    except BrakeCalError as error:
        return Row(cause, keep_v, refused=f"validate: {error}")
    e = result.estimate
    front, rear = against_truth(e, truths_of(log))
    of_table = [warning for warning in table.warnings if warning.log != "coast"]
    return Row(
        cause,
        keep_v,
        valid=int(np.sum(e.valid)),
        braked=int(np.sum(e.braked & (e.speed > 3.0))),
        held=(float(np.sum(front.held)), float(np.sum(rear.held))),
        squares=(float(np.sum(front.error**2)), float(np.sum(rear.error**2))),
        codes=tuple(warning.code for warning in (*of_table, *result.warnings)),
    )


def printed(found: list[Row], causes: Sequence[str], with_v: bool) -> None:
    """Print the table, one line for each of the ``causes``."""
    print(f"\n{'with' if with_v else 'without'} v")
    print(f"{'cause':20} {'stops':>5} {'refused':>7} {'coverage f/r':>13} {'valid':>6} "
          f"{'rms f/r %':>12} {'warned':>7} {'unwarned f/r':>13}   codes")  # fmt: skip
    for cause in causes:
        part = [r for r in found if (r.cause, r.with_v) == (cause, with_v)]
        if not part:
            continue
        answered = [r for r in part if not r.refused]
        quiet = [r for r in answered if not r.codes]
        valid, braked = sum(r.valid for r in answered), sum(r.braked for r in answered)
        counted = Counter(code for r in answered for code in set(r.codes))
        codes = ", ".join(f"{code} {n}" for code, n in counted.most_common(3))
        print(f"{cause:20} {len(part):5} {len(part) - len(answered):7} {coverage(answered):>13} "
              f"{valid / braked if braked else 0.0:6.2f} {rms(answered):>12} "
              f"{share(len(answered) - len(quiet), len(answered)):>7} {coverage(quiet):>13}   "
              f"{codes}")  # fmt: skip
    refusals = Counter(r.refused for r in found if r.refused and r.with_v == with_v)
    for text, n in refusals.most_common(5):
        print(f"refused {n}: {text[:160]}")


def coverage(part: list[Row]) -> str:
    """Share of valid samples whose interval holds the truth, front and rear."""
    valid = sum(r.valid for r in part)
    if not valid:
        return "none"
    f, b = (sum(r.held[k] for r in part) / valid for k in (0, 1))
    return f"{f:.2f} / {b:.2f}"


def rms(part: list[Row]) -> str:
    """Root mean square of the relative error, front and rear, in percent."""
    valid = sum(r.valid for r in part)
    if not valid:
        return "none"
    f, b = (100 * np.sqrt(sum(r.squares[k] for r in part) / valid) for k in (0, 1))
    return f"{f:.1f} / {b:.1f}"


def share(hits: int, n: int) -> str:
    """A share in percent."""
    return f"{100 * hits / n:.0f} %" if n else "none"


def main() -> None:
    """Run the study."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cars", type=int, default=6)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--cause", action="append", choices=list(CAUSES), metavar="CAUSE")
    parser.add_argument("--weighed", action="store_true")
    asked = parser.parse_args()
    each = [(c, i) for c in asked.cause or CAUSES for i in range(asked.cars)]
    jobs = [(c, asked.seed, i, asked.weighed) for c, i in each]
    found = [row for part in carried_out(tried, jobs, asked.jobs) for row in part]
    told = ", mass known to 0.5 %" if asked.weighed else ""
    print(f"{asked.cars} cars a cause, seed {asked.seed}{told}")
    for with_v in (True, False):
        printed(found, list(CAUSES), with_v)


if __name__ == "__main__":
    main()

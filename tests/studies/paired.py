"""Estimators side by side on the same stops, over all braked samples: which is better, and where.

    python tests/studies/paired.py --cars 12 --seed 11 [--only n] [--within] [--scatter 2]
    python tests/studies/paired.py --logs DIR... [--keep FILE] [--beside FILE]

For each car: a table from ramp and coast with the reference speed and one without, then all stops
with that table. Cars are drawn from `plant_r`, or read from folders that hold their truth. What is
counted, and the figures, are those of `tests.studies.scored_stop`; stops weigh alike, and parts of
stops by deceleration. An estimator is a set of columns of an estimate: those without prefix, and
those of the ECU (``ecu_``) where there are any. ``--keep`` writes the figures of each stop as a CSV
file; ``--beside`` reads such a file of another program and prints our rms, its own and the
quotient, on the stops that both answered.

``only`` n or v: without or with v. ``within`` adds the stops of `tests.studies.brakings.WITHIN`.
"""

import sys
import time
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import numpy as np
import pandas as pd

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import BrakeCalError
from calib.estimation.estimator import COLUMNS as OF_ESTIMATE
from calib.estimation.estimator import estimate
from calib.fitting.fit import fit
from calib.table.table import Table
from tests.studies.brakings import WITHIN
from tests.studies.plant_r import Case, Stop, drawn
from tests.studies.recorded_cars import folders, recorded
from tests.studies.scored_stop import BITE, DECELERATIONS, Truth, estimators, scored
from tests.studies.study import arguments, carried_out
from tests.support.reference_car import without

Row = dict[str, float | str]
Job = tuple[str, int, int, float, bool, tuple[str, ...]]

WITH = {"v": "with v", "n": "without v"}
COLUMNS = ("car", "tyre", "v", "stop", "number", "estimator", "deceleration", "refused", "seconds",
           "ramp error", "file error", "ramp held")  # fmt: skip


def tried(job: Job) -> list[Row]:
    """All stops of one car: (folder, seed, number, scatter, within, with or without v)."""
    folder, seed, number, scatter, within, only = job
    case = recorded(Path(folder)) if folder else drawn(seed, number, scatter, within)
    about = {"car": Path(folder).name if folder else f"R {seed}.{number}", "tyre": case.tyre}
    return [{**about, "v": mode, **row} for mode in only for row in stops_of(case, mode)]


def stops_of(case: Case, mode: str) -> Iterator[Row]:
    """Fit once, estimate every stop; a refusal is a stop without an answer."""
    hidden = () if mode == "v" else ("v",)
    runs = [without(log, *hidden) for log in (case.ramp, case.coast) if log]
    begun = time.process_time()
    try:
        table = fit(case.vehicle, runs)
    except BrakeCalError as error:
        for stop in case.stops:
            yield from refused(stop, f"fit: {error}")
        return
    spent = time.process_time() - begun
    yield {"stop": "ramp", "seconds": spent, **ramp_figures(table, case)}
    for number, stop in enumerate(case.stops):
        begun = time.process_time()
        try:
            estimated = estimate(table, without(stop.log, *hidden))
            spent = time.process_time() - begun
        except BrakeCalError as error:
            yield from refused(stop, f"estimate: {error}")
            continue
        about: Row = {"stop": stop.surface, "number": number, "seconds": spent}
        frame, truth = estimated.to_frame(), Truth.of_stop(stop.log, case.vehicle)
        for name, prefix in estimators(frame.columns).items():
            for figures in scored(frame, prefix, case.vehicle, truth):
                yield {**about, "estimator": name, **figures}


def refused(stop: Stop, why: str) -> Iterator[Row]:
    """What is known of a stop that was refused."""
    for name in estimators(OF_ESTIMATE):
        yield {"stop": stop.surface, "estimator": name, "deceleration": "all", "refused": why,
               "answered": 0.0, "valid": 0.0}  # fmt: skip


def ramp_figures(table: Table, case: Case) -> Row:
    """Error of ln of the pads' ratio over the ramp, by the table and by the file, where it is
    known; whether the interval of the table holds it."""
    truth = case.ramp.truth
    if "true_mu_pad_f" not in truth:
        return {}
    apart = np.log(truth["true_mu_pad_f"] / truth["true_mu_pad_r"])
    true = np.mean(apart[case.ramp["p_mc"] > BITE])
    filed = np.log(case.vehicle.front.pad_friction / case.vehicle.rear.pad_friction)
    fitted = table.calibration.pad_log_ratio
    low, high = fitted.ci95
    return {
        "ramp error": float(filed + fitted.value - true),
        "file error": float(filed - true),
        "ramp held": float(low <= true - filed <= high),
    }


def summary(part: pd.DataFrame) -> str:
    """One line of figures of a group."""
    rms = 100.0 * np.sqrt(part[[f"square {q}" for q in ("front", "rear", "torque")]].mean())
    half = 100.0 * part[["half front", "half rear"]].median()
    coverage = part[[f"held {q}" for q in ("level", "ratio", "front", "rear", "torque")]].mean()
    within = part[["held valid front", "held valid rear"]].mean()
    return (
        f"{len(part):5} {part['answered'].mean():5.2f} {part['valid'].mean():5.2f}  "
        f"{'/'.join(f'{x:.1f}' for x in rms[:2]):>9} {rms.iloc[2]:5.1f}  "
        f"{'/'.join(f'{x:.1f}' for x in half):>9}  "
        f"{' '.join(share(x) for x in coverage)}  {'/'.join(map(share, within)):>9}"
    )


def share(x: float) -> str:
    """A share in four characters."""
    return "   -" if np.isnan(x) else f"{x:4.2f}"


HEAD = (
    f"{'':23} stops  ans. valid  rms f/r % total  half f/r %  "
    "cover: level ratio front rear torque, of valid"
)


def groups(rows: pd.DataFrame) -> Iterator[tuple[str, pd.DataFrame]]:
    """All stops, less those of `WITHIN`: together, by road or car, by tyre, by deceleration; then
    each of `WITHIN`."""
    apart, whole = rows["stop"].isin(WITHIN), rows["deceleration"] == "all"
    yield "all", rows[whole & ~apart]
    for column in ("group", "tyre"):
        for name in rows.loc[~apart & (rows[column] != ""), column].unique():
            yield str(name), rows[whole & ~apart & (rows[column] == name)]
    for name in DECELERATIONS:
        yield name, rows[~apart & (rows["deceleration"] == name)]
    for name in WITHIN:
        yield name, rows[whole & (rows["stop"] == name)]


def printed(rows: pd.DataFrame) -> None:
    """The tables, one for each estimator with and without v, and the cost."""
    answered = rows[rows["estimator"].notna()]
    for (mode, name), part in answered.groupby(["v", "estimator"], sort=False):
        print(f"\n{name}, {WITH[mode]}\n{HEAD}")
        for group, of in groups(part):
            if len(of):
                print(f"{group:23} {summary(of)}")
    for mode, part in rows.groupby("v", sort=False):
        print_totals(str(mode), part)


def print_totals(mode: str, rows: pd.DataFrame) -> None:
    """What is said once: the ratio of the ramp, refusals, seconds."""
    ramps = rows[rows["stop"] == "ramp"]
    print(f"\n{WITH[mode]}:")
    if ramps["ramp error"].notna().any():
        error, file = ramps["ramp error"].dropna(), ramps["file error"].dropna()
        print(f"  ln of the ramp's pad ratio: bias {error.mean():+.3f} +- "
              f"{error.sem():.3f}, rms {np.sqrt((error**2).mean()):.3f}, the file's "
              f"{np.sqrt((file**2).mean()):.3f}, held {ramps['ramp held'].mean():.2f}")  # fmt: skip
    whole = rows[rows["deceleration"] == "all"].drop_duplicates(["car", "number"])
    print(f"  seconds of the processor, median and most: fit {ramps['seconds'].median():.2f} "
          f"{ramps['seconds'].max():.2f}, estimate {whole['seconds'].median():.3f} "
          f"{whole['seconds'].max():.3f}")  # fmt: skip
    for text, n in rows["refused"].value_counts().items():
        print(f"  refused {n}: {str(text)[:160]}")


def compared(rows: pd.DataFrame, theirs: pd.DataFrame) -> None:
    """Rms of ours, of the other program's, and their quotient, on the stops of both."""
    squares = [f"square {q}" for q in ("front", "rear", "torque")]
    for name in rows["estimator"].dropna().unique():
        ours = rows[rows["estimator"] == name]
        merged = ours.merge(theirs[theirs["estimator"] == "today"], on=["car", "stop",
                          "number", "v", "deceleration"], suffixes=("", " before"))  # fmt: skip
        merged = merged.dropna(subset=[f"square front{end}" for end in ("", " before")])
        for mode, part in merged.groupby("v", sort=False):
            print(f"\n{name} over the other program, {WITH[mode]}: "
                  "rms % f/r total, the other's, quotient")  # fmt: skip
            for group, rows_of_group in groups(part):
                if len(rows_of_group):
                    now, then = (
                        100
                        * np.sqrt(rows_of_group[[f"{s}{end}" for s in squares]].mean().to_numpy())
                        for end in ("", " before")
                    )
                    three = ["/".join(f"{x:.1f}" for x in y) for y in (now, then)]
                    quotient = "/".join(f"{x:.2f}" for x in now / then)
                    print(
                        f"{group:23} {len(rows_of_group):4} "
                        f"{three[0]:>14} {three[1]:>14} {quotient:>15}"
                    )


def main() -> None:
    """Run the study."""
    options = arguments(__doc__, "within", cars=12, seed=11, scatter=1.0, jobs=1, only=["v", "n"],
                      logs=(), keep="", beside="")  # fmt: skip
    only = tuple(options.only)
    jobs: list[Job] = [(str(f), 0, 0, 1.0, False, only) for f in folders(options.logs)] or [
        ("", options.seed, i, options.scatter, options.within, only) for i in range(options.cars)
    ]
    figures = [row for part in carried_out(tried, jobs, options.jobs) for row in part]
    rows = pd.DataFrame(figures).reindex(columns=list(dict.fromkeys([*COLUMNS, *chain(*figures)])))
    if options.keep:
        rows.to_csv(options.keep, index=False)
    one_road = options.logs and rows["car"].nunique() > 1
    rows["group"] = rows["car" if one_road else "stop"]
    printed(rows)
    if options.beside:
        compared(rows, pd.read_csv(options.beside))


if __name__ == "__main__":
    main()

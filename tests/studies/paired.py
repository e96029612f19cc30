"""Estimators side by side on the same stops, over all braked samples: which is better, and where.

    python tests/studies/paired.py --cars 12 --seed 11 [--only n] [--within] [--scatter 2]
    python tests/studies/paired.py --cars 6 --seed 11 [--warned] [--bench]
    python tests/studies/paired.py --logs DIR... [--keep FILE] [--beside FILE]

For each car: a table from ramp and coast with the reference speed and one without, then all stops
with that table. Cars are drawn (``--plant`` R, M or integrated), or read from folders that hold
their truth. What is counted, and the figures, are those of `tests.studies.scored_stop`; stops weigh
alike, and parts of stops by deceleration. An estimator is a set of columns of an estimate: those
without prefix, and those of the ECU (``ecu_``) where there are any. ``--keep`` writes the figures
of each stop as a CSV file; ``--beside`` reads such a file of another program and prints our rms,
its own and the quotient, on the stops that both answered.

``only`` n or v: without or with v. ``within`` adds the stops of `tests.studies.brakings.WITHIN`.
``warned`` validates each stop and says how many are warned of, by the stop or by the ramp, and how
often the bounds of the others hold. ``bench`` gives `fit` a roller brake tester whose forces are
known to 1 %.
"""

import sys
import time
from collections import Counter
from collections.abc import Iterator
from itertools import chain
from pathlib import Path

import numpy as np
import pandas as pd

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import BrakeCalError
from calib.estimation.estimator import COLUMNS as OF_ESTIMATE
from calib.estimation.estimator import estimate
from calib.estimation.limits import DEFAULTS
from calib.estimation.validate import validate_one
from calib.fitting.fit import fit
from calib.logs.log import Log
from calib.model.roller_bench import AxleOnRollers, RollerBench
from calib.table.table import Table
from tests.studies import ensemble, plant_m, plant_r
from tests.studies.brakings import WITHIN, BeyondPeakError
from tests.studies.ensemble import Case, Stop
from tests.studies.recorded_cars import folders, recorded
from tests.studies.scored_stop import BITE, DECELERATIONS, Truth, estimators, scored
from tests.studies.study import arguments, carried_out
from tests.support.reference_car import without

Row = dict[str, float | str]
Job = tuple[str, str, int, int, float, bool, tuple[str, ...], bool, bool]

PLANTS = {"R": plant_r, "M": plant_m}
WITH = {"v": "with v", "n": "without v"}
ON_ROLLERS = 0.01
"""How well a roller brake tester knows the force of an axle, one sigma, relative [1]."""
COLUMNS = ("car", "tyre", "v", "stop", "number", "estimator", "deceleration", "refused", "seconds",
           "ramp error", "file error", "ramp held", "warned", "codes")  # fmt: skip


def drawn(plant: str, seed: int, number: int, scatter: float, within: bool) -> Case:
    """Car ``number`` of a plant; it is the same for any count. Another one is drawn for a car whose
    ramp is beyond the peak."""
    rng = np.random.default_rng([seed, number])
    if plant == "integrated":
        return ensemble.case(rng, 5, 1000 * seed + number)
    while True:
        try:
            return PLANTS[plant].case(rng, scatter, within)
        except BeyondPeakError:
            continue


def tried(job: Job) -> list[Row]:
    """All stops of one car: (plant, folder, seed, number, scatter, within, with or without v,
    warned, bench)."""
    plant, folder, seed, number, scatter, within, only, warned, bench = job
    of = recorded(Path(folder)) if folder else drawn(plant, seed, number, scatter, within)
    name = Path(folder).name if folder else f"{plant} {seed}.{number}"
    rollers = on_rollers(of, np.random.default_rng([seed, number, 1])) if bench else None
    out = []
    for mode in only:
        rows = stops_of(of, mode, warned, rollers)
        out += [{"car": name, "tyre": of.tyre, "v": mode, **row} for row in rows]
    return out


def on_rollers(of: Case, rng: np.random.Generator) -> RollerBench:
    """The pads of the ramp on rollers: ten rows an axle, half of the machine's error its own."""
    pressure = tuple(np.linspace(8e5, 40e5, 10))
    common, *own = rng.normal(0.0, ON_ROLLERS * np.sqrt(0.5), 3)
    axles = []
    for side, error in zip("fr", own, strict=True):
        axle = of.vehicle.front if side == "f" else of.vehicle.rear
        pads = float(np.mean(of.ramp.truth[f"true_mu_pad_{side}"][of.ramp["p_mc"] > BITE]))
        slope = 2.0 * axle.torque_gain * pads / axle.rolling_radius * np.exp(common + error)
        rows = slope * np.array(pressure) * np.exp(rng.normal(0.0, 0.3 * ON_ROLLERS, 10))
        axles.append(AxleOnRollers(pressure, tuple(rows)))
    return RollerBench("rollers", "", "", ON_ROLLERS, *axles)


def stops_of(of: Case, mode: str, warned: bool, rollers: RollerBench | None) -> Iterator[Row]:
    """Fit once, estimate every stop; a refusal is a stop without an answer."""
    hidden = () if mode == "v" else ("v",)
    runs = [without(log, *hidden) for log in (of.ramp, of.coast) if log]
    begun = time.process_time()
    try:
        table = fit(of.vehicle, runs, bench=rollers)
    except BrakeCalError as error:
        for stop in of.stops:
            yield from refused(stop, f"fit: {error}")
        return
    spent = time.process_time() - begun
    yield {"stop": "ramp", "seconds": spent, **ramp_figures(table, of)}
    for number, stop in enumerate(of.stops):
        begun = time.process_time()
        try:
            found = estimate(table, without(stop.log, *hidden))
            spent = time.process_time() - begun
            told = codes(table, without(stop.log, *hidden)) if warned else None
        except BrakeCalError as error:
            yield from refused(stop, f"estimate: {error}")
            continue
        about: Row = {"stop": stop.surface, "number": number, "seconds": spent}
        if told is not None:
            about |= {"warned": float(bool(told)), "codes": " ".join(told)}
        frame, truth = found.to_frame(), Truth.of(stop.log, of.vehicle)
        for name, prefix in estimators(frame.columns).items():
            for figures in scored(frame, prefix, of.vehicle, truth):
                yield {**about, "estimator": name, **figures}


def codes(table: Table, log: Log) -> list[str]:
    """Codes of the warnings on a stop and on the ramp of its table."""
    found = validate_one(table, log, None, DEFAULTS).warnings
    return sorted({one.code for one in (*table.warnings, *found) if one.log != "coast"})


def refused(stop: Stop, why: str) -> Iterator[Row]:
    """What is known of a stop that was refused."""
    for name in estimators(OF_ESTIMATE):
        yield {"stop": stop.surface, "estimator": name, "deceleration": "all", "refused": why,
               "answered": 0.0, "valid": 0.0}  # fmt: skip


def ramp_figures(table: Table, of: Case) -> Row:
    """Error of ln of the pads' ratio over the ramp, by the table and by the file, where it is
    known; whether the interval of the table holds it."""
    truth = of.ramp.truth
    if "true_mu_pad_f" not in truth:
        return {}
    apart = np.log(truth["true_mu_pad_f"] / truth["true_mu_pad_r"])
    true = np.mean(apart[of.ramp["p_mc"] > BITE])
    filed = np.log(of.vehicle.front.pad_friction / of.vehicle.rear.pad_friction)
    found = table.calibration.pad_log_ratio
    low, high = found.ci95
    return {
        "ramp error": float(filed + found.value - true),
        "file error": float(filed - true),
        "ramp held": float(low <= true - filed <= high),
    }


def summary(part: pd.DataFrame) -> str:
    """One line of figures of a group."""
    rms = 100.0 * np.sqrt(part[[f"square {q}" for q in ("front", "rear", "torque")]].mean())
    half = 100.0 * part[["half front", "half rear"]].median()
    held = part[[f"held {q}" for q in ("level", "ratio", "front", "rear", "torque")]].mean()
    within = part[["held valid front", "held valid rear"]].mean()
    return (
        f"{len(part):5} {part['answered'].mean():5.2f} {part['valid'].mean():5.2f}  "
        f"{'/'.join(f'{x:.1f}' for x in rms[:2]):>9} {rms.iloc[2]:5.1f}  "
        f"{'/'.join(f'{x:.1f}' for x in half):>9}  "
        f"{' '.join(share(x) for x in held)}  {'/'.join(map(share, within)):>9}{quiet(part)}"
    )


def quiet(part: pd.DataFrame) -> str:
    """Share of the stops that are warned of, and coverage of the others."""
    if part["warned"].isna().all():
        return ""
    of = part.loc[part["warned"] == 0.0, ["held front", "held rear"]].mean()
    return f"   {part['warned'].mean():4.2f} {'/'.join(map(share, of)):>9}"


def share(x: float) -> str:
    """A share in four characters."""
    return "   -" if np.isnan(x) else f"{x:4.2f}"


HEAD = (
    f"{'':23} stops  ans. valid  rms f/r % total  half f/r %  "
    "cover: level ratio front rear torque, of valid (warned, of the others f/r)"
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
        told(str(mode), part)


def told(mode: str, rows: pd.DataFrame) -> None:
    """What is said once: the ratio of the ramp, refusals, seconds."""
    ramps = rows[rows["stop"] == "ramp"]
    print(f"\n{WITH[mode]}:")
    if ramps["ramp error"].notna().any():
        error, file = ramps["ramp error"].dropna(), ramps["file error"].dropna()
        print(f"  ln of the ramp's pad ratio: bias {error.mean():+.3f} +- "
              f"{error.sem():.3f}, rms {np.sqrt((error**2).mean()):.3f}, the file's "
              f"{np.sqrt((file**2).mean()):.3f}, held {ramps['ramp held'].mean():.2f}")  # fmt: skip
    whole = rows[rows["deceleration"] == "all"].drop_duplicates(["car", "number"])
    told = Counter(code for text in whole["codes"].dropna() for code in str(text).split())
    if told:
        print("  warned of: " + ", ".join(f"{code} {n}" for code, n in told.most_common()))
    print(f"  seconds of the processor, median and most: fit {ramps['seconds'].median():.2f} "
          f"{ramps['seconds'].max():.2f}, estimate {whole['seconds'].median():.3f} "
          f"{whole['seconds'].max():.3f}")  # fmt: skip
    for text, n in rows["refused"].value_counts().items():
        print(f"  refused {n}: {str(text)[:160]}")


def compared(rows: pd.DataFrame, before: pd.DataFrame) -> None:
    """Rms of ours, of the other program's, and their quotient, on the stops of both."""
    squares = [f"square {q}" for q in ("front", "rear", "torque")]
    for name in rows["estimator"].dropna().unique():
        ours = rows[rows["estimator"] == name]
        both = ours.merge(before[before["estimator"] == "today"], on=["car", "stop",
                          "number", "v", "deceleration"], suffixes=("", " before"))  # fmt: skip
        both = both.dropna(subset=[f"square front{end}" for end in ("", " before")])
        for mode, part in both.groupby("v", sort=False):
            print(f"\n{name} over the other program, {WITH[mode]}: "
                  "rms % f/r total, the other's, quotient")  # fmt: skip
            for group, of in groups(part):
                if len(of):
                    now, then = (
                        100 * np.sqrt(of[[f"{s}{end}" for s in squares]].mean().to_numpy())
                        for end in ("", " before")
                    )
                    three = ["/".join(f"{x:.1f}" for x in y) for y in (now, then)]
                    quotient = "/".join(f"{x:.2f}" for x in now / then)
                    print(f"{group:23} {len(of):4} {three[0]:>14} {three[1]:>14} {quotient:>15}")


def main() -> None:
    """Run the study."""
    asked = arguments(__doc__, "within", "warned", "bench", cars=12, seed=11, scatter=1.0, jobs=1,
                      plant="R", only=["v", "n"], logs=(), keep="", beside="")  # fmt: skip
    how = tuple(asked.only), asked.warned, asked.bench
    jobs: list[Job] = [("", str(f), 0, 0, 1.0, False, *how) for f in folders(asked.logs)] or [
        (asked.plant, "", asked.seed, i, asked.scatter, asked.within, *how)
        for i in range(asked.cars)
    ]
    found = [row for part in carried_out(tried, jobs, asked.jobs) for row in part]
    rows = pd.DataFrame(found).reindex(columns=list(dict.fromkeys([*COLUMNS, *chain(*found)])))
    if asked.keep:
        rows.to_csv(asked.keep, index=False)
    one_road = asked.logs and rows["car"].nunique() > 1
    rows["group"] = rows["car" if one_road else "stop"]
    printed(rows)
    if asked.beside:
        compared(rows, pd.read_csv(asked.beside))


if __name__ == "__main__":
    main()

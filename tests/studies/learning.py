"""What ten stops of a car add to its ramp: rms, half widths and coverage on stops held out.

    python tests/studies/learning.py --cars 10 --seed 77 [--only n]
    python tests/studies/learning.py --logs DIR...

Cars and stops are drawn from `beliefs.csv` and driven by `tests.studies.plant_r`, as
`tests.studies.coverage` does; or read from folders that hold their truth, where each half of the
stops is held out once. Each car is fitted from ramp and coast alone, and with the stops. Printed
are figures of both and their quotient, over the braked samples of `tests.studies.scored_stop`, and
a bound: how far the pads' ratio of another stop could be narrowed if the stops had no noise, their
tyres were the program's, and somebody said which case of the list each stop is. It is the Fisher
information of the linear model of the draws (Bayes linear: Goldstein and Wooff 2007).
"""

import sys
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pandas as pd

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import BrakeCalError
from calib.car.vehicle import Vehicle
from calib.estimation.estimator import estimate
from calib.fitting.ensemble import Ensemble, ensemble_of
from calib.fitting.fit import fit
from calib.fitting.maps import predict_stops, scenarios
from calib.logs.log import Log
from calib.table.table import Table
from tests.studies.coverage import GOLDEN, car_and_runs, limits, ranked, stop
from tests.studies.recorded_cars import folders, recorded
from tests.studies.scored_stop import QUANTITIES, Truth, answer
from tests.studies.study import arguments, tabulated
from tests.support.reference_car import without

LEARNT, HELD_OUT = 10, 5
WITH = {"v": "with v", "n": "without v"}
PREFIX = {"v": "", "n": "ecu_"}
Job = tuple[str, int, int, tuple[str, ...]]
Row = dict[str, float | str]


def runs_of(job: Job) -> tuple[str, Vehicle, list[Log], list[tuple[list[Log], list[Log]]]]:
    """Name of a car, its file, ramp and coast, and stops to learn from with those held out."""
    folder, seed, number, _ = job
    if folder:
        case = recorded(Path(folder))
        logs = [one.log for one in case.stops]
        halves = [(logs[::2], logs[1::2]), (logs[1::2], logs[::2])]
        return Path(folder).name, case.vehicle, [x for x in (case.ramp, case.coast) if x], halves
    rng = np.random.default_rng([seed, number])
    car, ramp, coast = car_and_runs(rng, (0.5 + number * GOLDEN) % 1.0)
    logs = [stop(rng, car, f"stop {i}").log for i in range(LEARNT + HELD_OUT)]
    return f"{seed}:{number}", car.vehicle, [ramp, coast], [(logs[:LEARNT], logs[LEARNT:])]


def tried(job: Job) -> list[Row]:
    """Figures of one car: (folder, seed, number, with or without v)."""
    name, car, runs, parts = runs_of(job)
    rows: list[Row] = []
    for mode in job[3]:
        hidden = () if mode == "v" else ("v",)
        for learnt, held_out in parts:
            about: Row = {"car": name, "v": mode}
            try:
                ramp_table = fit(car, [without(log, *hidden) for log in runs])
                stops_table = fit(car, [without(log, *hidden) for log in (*runs, *learnt)])
            except BrakeCalError as error:
                rows.append({**about, "refused": str(error)[:150]})
                continue
            bounds = {
                f"bound {x}": np.nan if job[0] else bound(ramp_table, x, mode == "v") for x in BEST
            }
            rows.append({**about, **bounds})
            for i, log in enumerate(held_out):
                for what, table in (("ramp", ramp_table), ("stops", stops_table)):
                    rows += scored(table, without(log, *hidden), car, mode, {**about, "stop": i,
                                   "table": what})  # fmt: skip
    return rows


def scored(table: Table, log: Log, car: Vehicle, mode: str, about: Row) -> list[Row]:
    """Figures of one stop by quantity."""
    truth = Truth.of_stop(log, car)
    if not truth.counted.any():
        return []
    answers = answer(estimate(table, log).to_frame(), PREFIX[mode], car)
    return [
        {**about, "quantity": name,
         **ranked(answers[name], truth.quantities[name], truth.counted)}
        for name in QUANTITIES
    ]  # fmt: skip


ROADS = ("same", 0.7, 0.4, 0.9, "same", 0.4, 0.8, "same", "same", 0.6)
PADS = (0.03, 0.17, 0.03, 0.4, 0.03, 0.17, 0.17, 0.03, 0.03, 0.17)
"""A usual draw of ten from the list: peaks of the roads, and scatter of the pads."""
BEST = {"list": False, "best": True}
"""Ten stops of the list from 0.1 to 0.55 g; or all with the ramp's pads on its road, from 0.12 g up
to nine tenths of the peak."""


def bound(table: Table, stops: str, v: bool, count: int = 8192) -> float:
    """Half width of the pads' ratio of another stop, with ``stops`` over without them."""
    car, rng, best = table.vehicle, np.random.default_rng(7), BEST[stops]
    e = ensemble_of(car, table.draws)
    top = 0.9 * float(np.median(e.peak)) if best else 0.55
    roads, pads = (("same",) * 10, (0.03,) * 10) if best else (ROADS, PADS)
    columns, ratio, rolls = drawn(car, e, 0.35, "same", 0.17, rng, count)
    shown = [columns[: 1 + v]]
    for z, road, scatter in zip(np.linspace(0.12, top, 10), roads, pads, strict=True):
        columns, _, rolling = drawn(car, e, float(z), road, scatter, rng, count)
        shown.append(columns[: 1 + v])
        rolls = rolls & rolling
    widths = [remaining(np.vstack(x)[:, rolls], ratio[rolls]) for x in (shown[:1], shown)]
    return widths[1] / widths[0]


def drawn(
    car: Vehicle, e: Ensemble, z: float, road: str | float, scatter: float,
    rng: np.random.Generator, count: int,
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:  # fmt: skip
    """eta and slip of a stop (2, n) without noise, its pads' ratio (n,), whether it rolls (n,)."""
    s, normal = scenarios(car, e, count), rng.standard_normal
    peak = np.exp(0.03 * normal(count))
    stiff = 0.02 * normal(count)
    if not isinstance(road, str):
        peak, stiff = road * peak / s.cars.peak, 0.3 * normal(count)
    s = replace(
        s,
        change=scatter * normal(count),
        peak=peak,
        stiffer=stiff + 0.02 * normal((2, count)),
        scale=0.009 * (1.0 + normal(count)),
        offset=0.001 * normal(count),
    )
    by = predict_stops(car, s, np.array([z]))
    slips = np.stack(
        [np.arcsinh(by.eta_rise[:, 0] / z / 0.004), np.log(np.maximum(by.slip[:, 0], 1e-5))]
    )
    return slips, s.log_pad_ratio, by.rolls[:, 0]


def remaining(x: np.ndarray, y: np.ndarray) -> float:
    """Standard deviation of ``y`` (n,) that a linear function of ``x`` (k, n) leaves."""
    x = (x - x.mean(axis=1, keepdims=True)) / x.std(axis=1, keepdims=True)
    y = y - y.mean()
    weights = np.linalg.solve(x @ x.T + 1e-9 * y.size * np.eye(len(x)), x @ y)
    return float(np.std(y - weights @ x))


HEAD = (
    "         rms %: ramp  stops quotient (limits)     half %: ramp stops quotient  "
    "95 %: ramp stops (limits)"
)


def summary(rows: pd.DataFrame) -> None:
    """The tables."""
    for mode, of_mode in rows.groupby("v", sort=False):
        fits = of_mode[of_mode["table"].isna()]
        by_list, best = fits["bound list"].median(), fits["bound best"]
        print(
            f"\n{WITH[str(mode)]}: {fits['car'].nunique()} cars; half width of the ratio at least"
        )
        print(f"{by_list:.2f} of a ramp's by ten stops of the list, {best.median():.2f} "
              f"({best.min():.2f}-{best.max():.2f}) by the best\n{HEAD}")  # fmt: skip
        for name in QUANTITIES:
            of_name = of_mode[of_mode["quantity"] == name]
            print(f"{name:8} {_line(*(of_name[of_name['table'] == x] for x in ('ramp', 'stops')))}")
    for text, n in rows.get("refused", pd.Series()).value_counts().items():
        print(f"refused {n}: {text}")


def _line(ramp: pd.DataFrame, stops: pd.DataFrame) -> str:
    """Figures of both tables, with 95 % limits of the quotient of rms by resampling the cars."""
    rms = [100.0 * np.sqrt(x["square"].mean()) for x in (ramp, stops)]
    half = [100.0 * x["half"].median() for x in (ramp, stops)]
    sums = [x.groupby("car")["square"].sum().to_numpy() for x in (ramp, stops)]
    places = np.random.default_rng(1).integers(sums[0].size, size=(400, sums[0].size))
    squares = sums[1][places].sum(axis=1) / sums[0][places].sum(axis=1)
    low, high = np.percentile(np.sqrt(squares), [2.5, 97.5])
    shares = [x["held 0.95"].mean() for x in (ramp, stops)]
    return (
        f"{rms[0]:12.2f} {rms[1]:6.2f} {rms[1] / rms[0]:6.2f} ({low:.2f}-{high:.2f})  "
        f"{half[0]:12.2f} {half[1]:6.2f} {half[1] / half[0]:6.2f}  "
        "{:12.3f} {:.3f} ({:.2f}-{:.2f})".format(*shares, *limits(stops))
    )


def main() -> None:
    """Run the study."""
    options = arguments(__doc__, cars=10, seed=77, jobs=1, only=["v", "n"], logs=(), keep="")
    only: Sequence[str] = tuple(options.only)
    jobs: list[Job] = [(str(f), 0, 0, tuple(only)) for f in folders(options.logs)] or [
        ("", options.seed, i, tuple(only)) for i in range(options.cars)
    ]
    summary(tabulated(tried, jobs, options))


if __name__ == "__main__":
    main()

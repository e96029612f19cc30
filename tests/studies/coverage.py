"""Whether the bounds mean what they say: ranks of the truth on cars drawn from the product's lists.

    python tests/studies/coverage.py --cars 40 --seed 5 [--first 0] [--only n] [--keep FILE]
    python tests/studies/coverage.py --kept FILE...

Simulation-based calibration (Talts et al. 2018, arXiv:1804.06788): where cars and stops are drawn
from the very priors that the program has, the rank of the truth in what it answers is uniform. Cars
and stops are drawn from `beliefs.csv`, and go through `tests.studies.plant_r`, whose
tyres are other curves: one form a car. Half of the files say that the car was weighed. A compliance
is drawn within the range of its source; of a ramp or a stop beyond the peak all is drawn anew, as
the maps leave it out. Deceleration and level of the pads are on no list: 0.08 to 0.6 g, 0.6 to 1.1.
The pads' ratio of the ramp, of which a ramp tells little and which all stops of a car share, lies
evenly in its prior over the cars: few cars then tell more.

An answer is a median with 95 % bounds, so the rank is that in two halves of a normal distribution
of the logarithm, which meet the bounds. Printed for each quantity: the share of ranks in ten equal
bins, coverage at 50, 80 and 95 %, mean and deviation of the error over its sigma (0 and 1 where the
bounds are right, less than 1 where they are too wide), rms error and median half width; then by
group. Counted are the samples of `tests.studies.scored_stop`, valid or not; stops weigh alike.
"""

import sys
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pandas as pd
from scipy.special import ndtr, ndtri

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.arrays import Array
from calib.base.errors import BrakeCalError
from calib.base.intervals import Z95
from calib.car.beliefs import CAR, LOG, STOP, Belief
from calib.car.mass import WEIGHED
from calib.car.vehicle import Vehicle
from calib.estimation.estimator import estimate
from calib.fitting.fit import fit
from calib.logs.log import Log
from tests.studies import plant_r
from tests.studies.brakings import BeyondPeakError, Braking, Demand, brakings, held_pressure
from tests.studies.plant_r import Car, G
from tests.studies.scored_stop import QUANTITIES, Truth, answer, estimators
from tests.studies.study import arguments, tabulated
from tests.support.reference_car import without

COMPLIANCE = (1 / 70, 1 / 14)
"""Range of the source of the prior, slip per force over load [1]."""

PEAK, STIFF = 0.9, 0.25
"""Of another road: the peak [1] whose stiffness is that of the list, and the power with which the
stiffness goes with the peak. In words in the list."""

LEVELS = {0.5: 0.6745, 0.8: 1.2816, 0.95: Z95}
"""Half width of an interval, in sigmas, by its share."""

GOLDEN = 0.5 * (5.0**0.5 - 1.0)
"""Whose multiples lie evenly between whole numbers."""

BINS = tuple(f"bin {i}" for i in range(10))
WITH = {"v": "with v", "n": "without v"}
GROUPED = (("v", "best"), ("n", "ecu"))
"""What is shown by group: with all channels, and with those of the ECU alone."""

Job = tuple[int, int, tuple[str, ...]]


@dataclass(frozen=True)
class Driven:
    """A stop: its log, and the groups that it belongs to, by what they are groups of."""

    log: Log
    groups: dict[str, str]


def normal(rng: np.random.Generator, belief: Belief) -> float:
    """A draw of a prior."""
    return float(rng.normal(belief.mean, belief.sigma))


def brought(rng: np.random.Generator, name: str, cause: str = "") -> tuple[float, str]:
    """A draw of what a stop brings, and its cause; ``cause`` where it is already known."""
    mixture = getattr(STOP, name)
    case = int(rng.choice(len(mixture.cases), p=mixture.share / mixture.share.sum()))
    if cause:
        case = mixture.cases.index(cause)
    return float(rng.normal(mixture.mean[case], mixture.sigma[case])), mixture.cases[case]


def drawn(rng: np.random.Generator, place: float) -> Car:
    """A car from the priors; what is on no list as `plant_r.car` has it; ``place`` of the pads'
    ratio in its prior, 0 to 1."""
    base = plant_r.car(rng)
    weighed = bool(rng.random() < 0.5)
    file = replace(base.vehicle, mass_tolerance=WEIGHED if weighed else Vehicle.mass_tolerance)
    compliance = 0.0
    while not COMPLIANCE[0] < compliance < COMPLIANCE[1]:
        compliance = normal(rng, CAR.compliance)
    level, apart = rng.normal(0.0, 0.1), CAR.log_pad_ratio.sigma * float(ndtri(place))
    front, rear = file.front.pad_friction, file.rear.pad_friction
    return replace(
        base,
        vehicle=file,
        stiffness=1.0 / compliance,
        peak=float(np.exp(normal(rng, CAR.peak))),
        load_exponent=normal(rng, CAR.load_exponent),
        peak_exponent=normal(rng, CAR.peak_load_exponent),
        pads=(front * np.exp(level + 0.5 * apart), rear * np.exp(level - 0.5 * apart)),
        tyre_ratio=float(np.exp(normal(rng, CAR.log_tyre_ratio))),
        radius_load=normal(rng, CAR.radius_load),
        mass=file.mass * float(np.exp(rng.normal(0.0, file.mass_tolerance))),
        cg_to_front_axle=file.cg_to_front_axle * float(np.exp(normal(rng, CAR.cg_to_front_axle))),
        cg_height=file.cg_height * float(np.exp(normal(rng, CAR.cg_height))),
        a_x_scale=1.0 / (1.0 - normal(rng, LOG.a_x_scale)),
        pitch=0.0,
    )


def car_and_runs(rng: np.random.Generator, place: float) -> tuple[Car, Log, Log]:
    """A car, its ramp and its coast; ``place`` as `drawn` has it."""
    while True:
        car = drawn(rng, place)
        runs = brakings(Demand(car.vehicle, car.mass, car.pads, car.peak), rng)
        with suppress(BeyondPeakError):
            ramp, coast = (plant_r.drive(car, name, runs[name], rng) for name in ("ramp", "coast"))
            return car, ramp, coast


def stop(rng: np.random.Generator, car: Car, name: str) -> Driven:
    """A stop from the list; drawn anew until its road carries it."""
    while True:
        with suppress(BeyondPeakError):
            return tried_stop(rng, car, name)


def tried_stop(rng: np.random.Generator, car: Car, name: str) -> Driven:
    """As `stop`. Raises BeyondPeakError."""
    change, pads_are = brought(rng, "log_pad_ratio")
    peak, road_is = brought(rng, "log_peak")
    stiff, _ = brought(rng, "log_stiffness", road_is)
    if road_is == "other road":
        stiff += STIFF * (peak - np.log(PEAK))
        peak -= np.log(car.peak)
    tyres = [brought(rng, "log_tyre")[0] for _ in "fr"]
    load, mass_is = brought(rng, "log_mass")
    z, level, v0 = rng.uniform(0.08, 0.6), rng.uniform(0.6, 1.1), rng.uniform(14.0, 32.0)
    pads = car.pads[0] * level * np.exp(0.5 * change), car.pads[1] * level * np.exp(-0.5 * change)
    unstated = mass_is != "as stated" and car.vehicle.mass_tolerance > WEIGHED
    today = replace(
        car,
        tyre_ratio=car.tyre_ratio * float(np.exp(tyres[1] - tyres[0])),
        a_x_scale=1.0 / (1.0 - brought(rng, "a_x_scale")[0]),
        mass=car.vehicle.mass * float(np.exp(load)) if unstated else car.mass,
    )
    demand = Demand(car.vehicle, car.mass, car.pads, car.peak)
    road = float(np.exp(stiff + 0.5 * sum(tyres))), float(np.exp(peak))
    run = Braking(held_pressure(demand.pressure(z, pads)), v0, pads, road)
    log = plant_r.drive(today, name, run, rng)
    more = G * brought(rng, "a_x_offset")[0] * (run.pressure[: log.time.size] > 0.0)
    log = replace(log, channels={**log.channels, "a_x": log["a_x"] - more})
    carries = float(np.exp(peak)) * car.peak
    slippery = "peak < .3" if carries < 0.3 else "peak .3-.6" if carries < 0.6 else "peak > .6"
    groups = {
        "road": "ramp's road" if road_is == "as on the ramp" else f"other road, {slippery}",
        "pads": f"pads {pads_are}",
        "mass": "weighed" if car.vehicle.mass_tolerance <= WEIGHED else
                "load unstated" if unstated else "mass of the file",
        "tyre": car.form,
    }  # fmt: skip
    return Driven(log, groups)


def tried(job: Job) -> list[dict[str, float | str]]:
    """Five stops of one car: (seed, car, with or without v)."""
    seed, number, modes = job
    rng = np.random.default_rng([seed, number])
    car, ramp, coast = car_and_runs(rng, (0.5 + number * GOLDEN) % 1.0)
    stops = [stop(rng, car, f"stop {i}") for i in range(5)]
    out: list[dict[str, float | str]] = []
    for mode in modes:
        hidden = () if mode == "v" else ("v",)
        about: dict[str, float | str] = {"car": f"{seed}:{number}", "v": mode}
        try:
            table = fit(car.vehicle, [without(log, *hidden) for log in (ramp, coast)])
        except BrakeCalError as error:
            out += [{**about, "stop": i, "refused": f"fit: {error}"} for i in range(len(stops))]
            continue
        for i, driven in enumerate(stops):
            frame = estimate(table, without(driven.log, *hidden)).to_frame()
            truth = Truth.of_stop(driven.log, car.vehicle)
            if not truth.counted.any():
                continue
            for name, prefix in estimators(frame.columns).items():
                answers = answer(frame, prefix, car.vehicle)
                z = float(np.median(truth.braking[truth.counted]))
                deceleration = "< .2 g" if z < 0.2 else ".2-.4 g" if z < 0.4 else "> .4 g"
                for quantity in QUANTITIES:
                    out.append({**about, "stop": i, "estimator": name, "quantity": quantity,
                                **driven.groups, "deceleration": deceleration,
                                **ranked(answers[quantity], truth.quantities[quantity],
                                         truth.counted)})  # fmt: skip
    return out


def ranked(
    answers: tuple[Array, Array, Array], true: Array, counted: Array
) -> dict[str, float | str]:
    """Where the truth lies in the answers, means over the counted samples [1]."""
    value, low, high = (np.log(x[counted]) for x in answers)
    off = np.log(true[counted]) - value
    sigma = np.where(off < 0.0, value - low, high - value) / Z95
    score = off / sigma
    rank = np.minimum((10.0 * ndtr(score)).astype(int), 9)
    out: dict[str, float | str] = {f"held {s}": float(np.mean(np.abs(score) <= x))
                                   for s, x in LEVELS.items()}  # fmt: skip
    out |= {name: float(np.mean(rank == i)) for i, name in enumerate(BINS)}
    out |= {"score": float(np.mean(score)), "score squared": float(np.mean(score**2))}
    out |= {"square": float(np.mean(np.expm1(off) ** 2))}
    return {**out, "half": float(np.median(0.5 * (np.exp(high - value) - np.exp(low - value))))}


def limits(part: pd.DataFrame, column: str = "held 0.95", draws: int = 400) -> tuple[float, float]:
    """95 % limits of a mean by resampling the cars."""
    by_car = part.groupby("car")[column].agg(["sum", "count"]).to_numpy()
    drawn_cars = np.random.default_rng(1).integers(len(by_car), size=(draws, len(by_car)))
    means = by_car[drawn_cars, 0].sum(axis=1) / by_car[drawn_cars, 1].sum(axis=1)
    low, high = np.percentile(means, [2.5, 97.5])
    return float(low), float(high)


def printed(rows: pd.DataFrame) -> None:
    """The tables, one for each estimator with and without v."""
    answered = rows[rows["quantity"].notna()]
    for (mode, name), part in answered.groupby(["v", "estimator"], sort=False):
        stops = part.drop_duplicates(["car", "stop"])
        print(f"\n{name}, {WITH[str(mode)]}: {stops['car'].nunique()} cars, {len(stops)} stops")
        print("          ranks in ten bins, %                 50 %  80 %  95 % (limits)     "
              "error/sigma   rms %  half %")  # fmt: skip
        for quantity in QUANTITIES:
            chosen = part[part["quantity"] == quantity]
            bins = " ".join(f"{100 * chosen[b].mean():3.0f}" for b in BINS)
            covers = "  ".join(f"{chosen[f'held {s}'].mean():4.2f}" for s in LEVELS)
            low, high = limits(chosen)
            mean = chosen["score"].mean()
            spread = float(np.sqrt(chosen["score squared"].mean() - mean**2))
            print(f"{quantity:8} {bins}  {covers} ({low:.2f}-{high:.2f})  {mean:+.2f} +- "
                  f"{spread:.2f}  {100 * np.sqrt(chosen['square'].mean()):6.1f} "
                  f"{100 * chosen['half'].median():6.1f}")  # fmt: skip
        if (mode, name) not in GROUPED:
            continue
        print(f"\n{'95 %, by group':24} stops  " + " ".join(f"{q:>6}" for q in QUANTITIES)
              + "   rms/half % front     rear")  # fmt: skip
        for column in ("road", "pads", "deceleration", "mass", "tyre"):
            for group, chosen in part.groupby(column):
                by = chosen.groupby("quantity")
                covers = " ".join(f"{by['held 0.95'].mean()[q]:6.2f}" for q in QUANTITIES)
                rms, half = 100 * np.sqrt(by["square"].mean()), 100 * by["half"].median()
                sharp = "  ".join(f"{rms[q]:5.1f}/{half[q]:4.1f}" for q in ("front", "rear"))
                print(f"{group:24} {len(chosen) // len(QUANTITIES):5}  {covers}        {sharp}")
    if "refused" in rows:
        for text, n in rows["refused"].value_counts().items():
            print(f"refused {n} stops: {str(text)[:150]}")


def main() -> None:
    """Run the study."""
    options = arguments(
        __doc__, cars=40, seed=5, first=0, jobs=1, only=["v", "n"], keep="", kept=()
    )
    if options.kept:
        printed(pd.concat([pd.read_csv(name) for name in options.kept]))
        return
    jobs: list[Job] = [
        (options.seed, i, tuple(options.only))
        for i in range(options.first, options.first + options.cars)
    ]
    printed(tabulated(tried, jobs, options))


if __name__ == "__main__":
    main()

"""Whether the C code of an ECU answers as Python does, on random stops of random cars.

    python tests/studies/ecu_equal.py --count 1000 --jobs 2

Every tenth stop has a new car, whose table is fitted to a ramp of it. A stop has its own pads, road
friction, pressures and noise; in some a sensor fails or a wheel locks. Differences are relative, of
all answers with their bounds; reasons are counted.
"""

import sys
from collections import Counter
from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.ecu.native import Native
from calib.estimation.channels import CHANNELS, samples_of
from calib.estimation.online import answered
from calib.fitting.fit import fit
from calib.table.exported import Precision, as_exported
from calib.table.table import Table
from tests.studies.study import arguments, carried_out
from tests.support.plant import as_log, drive, magic
from tests.support.reference_car import CAR, REAL, noisy, ramp

STEPS = (0.005, 0.01, 0.02)
HOW = {"double": Precision(), "single": Precision(single=True), "16 bits": Precision(12, 16)}


@dataclass(frozen=True)
class Found:
    """Largest relative difference by precision, reasons that differ, and which there were."""

    worst: dict[str, float]
    other: dict[str, int]
    reasons: Counter[int]


def main() -> None:
    """Draw, run both, print."""
    asked = arguments(__doc__, count=1000, seed=0, jobs=1)
    seeds = range(asked.seed, asked.seed + asked.count)
    found = list(carried_out(compared, seeds, asked.jobs))
    print(f"{len(found)} stops, {sum(sum(one.reasons.values()) for one in found)} samples\n")
    print("| | largest difference | 99 % of the stops below | reasons that differ |")
    print("|---|---|---|---|")
    for name in HOW:
        worst = np.array([one.worst[name] for one in found])
        other = sum(one.other[name] for one in found)
        print(f"| {name} | {worst.max():.2g} | {np.quantile(worst, 0.99):.2g} | {other} |")
    print("\nreasons:", dict(sorted(sum((one.reasons for one in found), Counter()).items())))


@lru_cache(maxsize=4)
def car_of(number: int) -> Table:
    """The table of a random car."""
    rng = np.random.default_rng([7, number])
    scale = rng.uniform(0.85, 1.15, 4)
    front = replace(CAR.front, rolling_radius=CAR.front.rolling_radius * scale[0])
    car = replace(CAR, mass=CAR.mass * scale[1], cg_height=CAR.cg_height * scale[2], front=front)
    plant = replace(REAL, vehicle=car, tyre=magic(25.0 * scale[3], 0.9))
    return fit(car, [noisy(ramp(plant), number)])


def compared(seed: int) -> Found:
    """One stop in Python and in C."""
    rng, table = np.random.default_rng([8, seed]), car_of(seed // 10)
    level, pads = rng.uniform(3e5, 40e5, 2), rng.uniform(0.15, 0.5, 2)
    on, off, again = np.cumsum(rng.uniform(0.3, 2.5, 3))
    plant = replace(
        REAL,
        vehicle=table.vehicle,
        tyre=magic(rng.uniform(8.0, 40.0), rng.uniform(0.3, 1.1)),
        pads=lambda t: tuple(pads),
    )
    rise = rng.uniform(0.05, 1.0)

    def pressure(t: float) -> float:
        first = level[0] * min(max((t - on) / rise, 0.0), 1.0) * (t < off)
        return first + level[1] * min(max((t - again) / rise, 0.0), 1.0)

    step = float(rng.choice(STEPS))
    run = drive(plant, pressure, rng.uniform(12.0, 40.0), duration=7.0, rate=1.0 / step)
    samples = samples_of(noisy(as_log(run), seed))
    if rng.random() < 0.3:
        i, k = rng.integers(len(samples)), rng.integers(len(CHANNELS))
        samples[i : i + 40, k] = rng.choice([np.nan, 1e9, 0.5 * samples[i, k]])
    worst, other, reasons = {}, {}, Counter[int]()
    for name, how in HOW.items():
        given = how.computed(samples)
        right = answered(as_exported(table, how), step, given)
        told = native_of(seed // 10, step, name).run(given)
        apart = np.abs(told - right) / np.maximum(np.abs(right), 1e-6)
        worst[name] = float(apart[:, 1:].max())
        other[name] = int(np.count_nonzero(told[:, 0] != right[:, 0]))
        reasons = Counter(right[:, 0].astype(int).tolist())
    return Found(worst, other, reasons)


@lru_cache(maxsize=16)
def native_of(car: int, step: float, name: str) -> Native:
    """The code of a car, compiled once."""
    return Native(car_of(car), step, HOW[name])


if __name__ == "__main__":
    main()

"""Weak front pads against swapped axles: how often does a validation tell which it is?

    python tests/studies/weak_pads.py [--cars 6] [--seed 15]

Cars drawn around the reference car get a table from a ramp of the independent plant. Then each is
stopped on five roads: with front pads of 0.5, 0.6 and 0.7 of their friction, which must be
estimated, and with front and rear wheel speeds swapped, which must be refused. Every stop is
judged with and without the reference speed.
"""

import argparse
import sys
from collections.abc import Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import LogError
from calib.car.bias import pressure_per_g
from calib.car.vehicle import Vehicle
from calib.estimation.axles import judge_axles
from calib.estimation.estimator import estimate
from calib.estimation.settings import SETTINGS
from calib.fitting.fit import fit
from calib.logs.log import Log
from calib.table.table import Table
from tests.support.plant import Plant, magic
from tests.support.reference_car import CAR, REAL, noisy, ramp, stop, swapped, with_pads, without

WEAK, SWAPPED = "weak front pads", "swapped axles"
CASES = ((WEAK, 0.5), (WEAK, 0.6), (WEAK, 0.7), (SWAPPED, 0.8), (SWAPPED, 1.0))
"""What is wrong, and the friction of the pads over that on the ramp [1]: of the front ones, or of
all."""

ROADS = {
    "as on the ramp": {},
    "softer": {"tyre": magic(16.0, 0.65)},
    "rear tyres 10 % softer": {"rear_stiffness": 0.9},
    "radius that falls with load": {"radius_load": 0.004},
    "pitch that a_x feels": {"pitch_frequency": 1.3, "pitch_felt": 0.02},
}


def a_car(rng: np.random.Generator) -> Vehicle:
    """A car around the reference car: mass, height of its mass and rear pistons are drawn."""
    mass, height, rear = rng.uniform((0.8, 0.85, 0.85), (1.2, 1.15, 1.1))
    return replace(
        CAR,
        mass=mass * CAR.mass,
        cg_height=height * CAR.cg_height,
        rear=replace(CAR.rear, piston_area=rear * CAR.rear.piston_area),
    )


def stops(car: Vehicle, rng: np.random.Generator) -> Iterator[tuple[str, float, Log]]:
    """What is wrong, its size, and the log."""
    usual = replace(REAL, vehicle=car)
    for road in ROADS.values():
        for what, share in CASES:
            plant: Plant = replace(usual, **road)
            rear = car.rear.pad_friction * (share if what == SWAPPED else 1.0)
            plant = with_pads(plant, share * car.front.pad_friction, rear)
            log = noisy(stop(plant, 0.3 * pressure_per_g(car)), int(rng.integers(2**31)))
            yield what, share, swapped(log) if what == SWAPPED else log


def refused(table: Table, log: Log) -> bool:
    """Whether a validation refuses the log for its axles, or stands behind no sample of it."""
    try:
        other = judge_axles(table, log, estimate(table, log))
    except LogError:
        return True
    return other is not None and other.log_odds > SETTINGS.axles_sure


def main() -> None:
    """Print how many logs are told right, by what is wrong and by what is logged."""
    options = argparse.ArgumentParser()
    options.add_argument("--cars", type=int, default=6)
    options.add_argument("--seed", type=int, default=15)
    given = options.parse_args()
    right: dict[tuple[str, float, str], list[bool]] = {}
    for number in range(given.cars):
        rng = np.random.default_rng((given.seed, number))
        car = a_car(rng)
        slope = 0.07 * pressure_per_g(car)
        table = fit(car, [noisy(ramp(replace(REAL, vehicle=car), slope), int(rng.integers(2**31)))])
        for what, share, log in stops(car, rng):
            for logged, one in (("with v", log), ("without v", without(log, "v"))):
                told = refused(table, one) == (what == SWAPPED)
                right.setdefault((what, share, logged), []).append(told)
    for (what, share, logged), told in right.items():
        print(f"{what}, pads {share:g}, {logged}: {sum(told)} of {len(told)} told right")


if __name__ == "__main__":
    main()

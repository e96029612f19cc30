"""Cars of nine kinds on wet asphalt, nothing hidden in them: none may be refused.

    python tests/studies/clean_cars.py [--cars 5] [--seed 1]

Each car has brakes that would be ideal at 0.7 to 1.4 g, pads that differ from the file's by up to a
tenth, alike on both axles, and tyres whose front ones slip by 3 to 4 % at the top of a ramp to
0.55 g, where they carry 0.8 to 0.95 of their peak; a coast log, and v. Printed by kind: how many
`fit` refuses, and over the others the rms error of the pads over their truth, front / rear, and how
often their 95 % interval holds it. At last why it refuses.
"""

import argparse
import math
import sys
from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
from scipy.optimize import brentq

sys.path.insert(0, str(Path(__file__).parents[2]))

from calib.base.errors import BrakeCalError
from calib.car.vehicle import Axle, Vehicle
from calib.fitting.fit import fit
from calib.logs.log import Log
from calib.model.sensor_noise import LEVELS, add_noise
from tests.support.cornering import GRAVITY
from tests.support.plant import Plant, as_log, drive, magic, per_pascal
from tests.support.reference_car import CAR

KINDS = {
    # mass [kg], share of the weight in front, wheelbase, height, rolling radii [m]
    "mid-engined": (1500.0, 0.425, 2.47, 0.46, 0.330, 0.338),
    "rear-engined": (1480.0, 0.39, 2.45, 0.50, 0.330, 0.345),
    "small rear-engined": (980.0, 0.45, 2.49, 0.54, 0.290, 0.300),
    "roadster": (1050.0, 0.50, 2.31, 0.45, 0.295, 0.302),
    "hatchback": (1350.0, 0.61, 2.62, 0.54, 0.316, 0.316),
    "electric saloon": (1950.0, 0.48, 2.88, 0.46, 0.334, 0.343),
    "laden estate": (2050.0, 0.46, 2.79, 0.58, 0.327, 0.325),
    "laden van": (2800.0, 0.44, 3.40, 0.72, 0.345, 0.345),
    "off-roader": (2200.0, 0.53, 2.85, 0.72, 0.380, 0.380),
}

BITE, TOP, RISE, SPEED = 1.5, 0.55, 6.5, 33.0
"""Time before the ramp [s], its top [g], its length [s] and the speed at its begin [m/s]."""


def vehicle(kind: str, rng: np.random.Generator) -> Vehicle:
    """A car of the kind, with 60 to 80 bar per g."""
    mass, front, wheelbase, height, radius_f, radius_r = KINDS[kind]
    front += float(rng.uniform(-0.015, 0.015))
    share = front + float(rng.uniform(0.7, 1.4)) * height / wheelbase
    pads = float(rng.uniform(0.36, 0.46))
    per_wheel = mass * GRAVITY / (2.0 * float(rng.uniform(60.0, 80.0)) * 1e5)
    axles = [
        Axle(radius, inertia, part * per_wheel * radius / (disc * 2 * pads), disc, 2, pads)
        for radius, inertia, part, disc in (
            (radius_f, 1.1, share, 0.150),
            (radius_r, 1.4, 1.0 - share, 0.140),
        )
    ]
    return replace(
        CAR,
        name=kind,
        mass=mass,
        cg_to_front_axle=(1.0 - front) * wheelbase,
        cg_to_rear_axle=front * wheelbase,
        cg_height=height,
        front=axles[0],
        rear=axles[1],
    )


def plant(kind: str, rng: np.random.Generator) -> Plant:
    """The car as it is; its front tyres slip by 3 to 4 % under the top of the ramp."""
    car = vehicle(kind, rng)
    level = 1.0 + float(rng.uniform(-0.1, 0.1))
    pads = level * car.front.pad_friction, level * car.rear.pad_friction
    gains = [a.torque_gain * a.pad_friction / a.rolling_radius for a in (car.front, car.rear)]
    length = car.cg_to_front_axle + car.cg_to_rear_axle
    z = level * TOP
    force = z * gains[0] / sum(gains) / ((car.cg_to_rear_axle + z * car.cg_height) / length)
    peak, curvature = force / float(rng.uniform(0.8, 0.95)), float(rng.uniform(-0.5, 0.3))
    slip = float(rng.uniform(0.03, 0.04))

    def short(stiffness: float) -> float:
        tyre = magic(stiffness, peak, curvature=curvature)
        return tyre(slip, 1.0, 1.0, 1.0) - force

    tyre = magic(float(brentq(short, 8.0, 60.0)), peak, curvature=curvature)
    return Plant(
        car,
        tyre=tyre,
        pads=lambda t: pads,
        drag_area=float(rng.uniform(0.55, 0.9)),
        rolling_resistance=float(rng.uniform(0.008, 0.014)),
        radius_scale=(1.0, 1.0 + float(rng.normal(0.0, 0.001))),
    )


def logs(made: Plant, seed: int) -> list[Log]:
    """The ramp and the coast log as sensors give them, of which some are quiet."""
    loud = float(np.random.default_rng(seed).uniform(0.3, 1.0))
    levels = {name: replace(level, sd=level.sd * loud) for name, level in LEVELS.items()}
    slope = TOP / per_pascal(made.vehicle) / RISE
    rising = lambda t: slope * max(t - BITE, 0.0)  # noqa: E731
    runs = (
        drive(made, rising, SPEED, duration=BITE + RISE, stop_speed=6.0),
        drive(made, lambda t: 0.0, SPEED - 3.0, duration=9.0),
    )
    return [
        add_noise(as_log(run, name), 2 * seed + k, levels)
        for k, (run, name) in enumerate(zip(runs, ("ramp", "coast"), strict=True))
    ]


def main() -> None:
    """Print one row per kind, and the sum."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cars", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    asked = parser.parse_args()
    refused: Counter[str] = Counter()
    every: list[tuple[float, ...]] = []
    for at, kind in enumerate(KINDS):
        found = []
        before = refused.total()
        for number in range(asked.cars):
            made = plant(kind, np.random.default_rng([asked.seed, at, number]))
            try:
                pads = fit(made.vehicle, logs(made, 100 * at + number)).calibration
            except BrakeCalError as error:
                refused[error.what] += 1
                continue
            axles = pads.pad_friction_f, pads.pad_friction_r
            pairs = list(zip(axles, made.pads(0.0), strict=True))
            errors = [axle.value / true - 1.0 for axle, true in pairs]
            found.append((*errors, *(a.ci95[0] < true < a.ci95[1] for a, true in pairs)))
        every += found
        print(f"{kind:20} refused {refused.total() - before} of {asked.cars}; {told(found)}",
              flush=True)  # fmt: skip
    print(f"{'all':20} refused {refused.total()} of {asked.cars * len(KINDS)}; {told(every)}")
    for what, count in refused.most_common():
        print(f"  {count}: {what}")


def told(found: list[tuple[float, ...]]) -> str:
    """Error and coverage in words."""
    x = np.array(found).reshape(-1, 4)
    rms = 100.0 * np.sqrt(np.mean(x[:, :2] ** 2, axis=0)) if found else (math.nan,) * 2
    held = np.mean(x[:, 2:], axis=0) if found else (math.nan,) * 2
    return f"rms {rms[0]:.1f} / {rms[1]:.1f} %, held {held[0]:.2f} / {held[1]:.2f}"


if __name__ == "__main__":
    main()

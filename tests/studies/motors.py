"""Motors that brake along in the stops only and are not logged: what `validate` makes of them.

    python tests/studies/motors.py --cars 5 --seed 1 [--torque 80] [--axle rear] [--ramp]

The cars of `ensemble`, each with a ramp, a coast and three stops, by kind of motor; car i is the
same car for every kind. The rows are those of `coverage_by_cause`.
"""

import argparse
import sys
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

sys.path.insert(0, str(Path(__file__).parents[2]))

from tests.studies.causes import BAR, COAST, RAMP, Hidden, grip
from tests.studies.coverage_by_cause import Row, printed, rows
from tests.studies.ensemble import case
from tests.studies.pool import carried_out
from tests.support.plant import Plant, Pressure, lagged

FADING = (2.8, 1.4)
"""Speeds [m/s] between which a motor hands over to the brakes: 10 and 5 km/h (our estimate)."""

CORNER = 12.0
"""Speed [m/s] from which the power of a motor limits its torque (our estimate)."""


def always(pressure: Pressure) -> Pressure:
    return lambda t: 1.0


def with_pedal(pressure: Pressure) -> Pressure:
    """All of it from 3 bar on."""
    return lambda t: min(max(pressure(t) / (3.0 * BAR), 0.0), 1.0)


def late(pressure: Pressure) -> Pressure:
    """All of it from 5 bar on, 0.2 s behind the pedal."""
    return lagged(lambda t: min(max(pressure(t) / (5.0 * BAR), 0.0), 1.0), 0.2, 30.0)


def along(pressure: Pressure) -> Pressure:
    """In proportion to the pressure up to 30 bar: as far as most stops go."""
    return lambda t: min(max(pressure(t) / (30.0 * BAR), 0.0), 1.0)


def all_the_way(v: float) -> float:
    return 1.0


def handed_over(v: float) -> float:
    """Gone as the car gets slow."""
    fast, slow = FADING
    return min(max((v - slow) / (fast - slow), 0.0), 1.0)


def of_little_power(v: float) -> float:
    """The same, and limited by its power above `CORNER`."""
    return handed_over(v) * min(1.0, CORNER / max(v, 1.0))


KINDS: dict[str, tuple[Callable[[Pressure], Pressure], Callable[[float], float]]] = {
    "constant": (always, all_the_way),
    "with the pedal": (with_pedal, all_the_way),
    "limited by power": (with_pedal, of_little_power),
    "late, handed over": (late, handed_over),
    "follows, handed over": (along, handed_over),
    "follows": (along, all_the_way),
}


def motor(kind: str, torque: float, front: bool, ramp: bool) -> Hidden:
    """``torque`` [N m a wheel] on an axle, in the stops and, if asked for, on the ramp; on a
    slippery road less, as stability control lets it."""
    course, share = KINDS[kind]

    def car(role: str, p: Plant, pressure: Pressure, v0: float) -> Plant:
        if role == COAST or (role == RAMP and not ramp):
            return p
        most, on = -2.0 * torque * grip(p), course(pressure)

        def pair(t: float) -> tuple[float, float]:
            return (most * on(t), 0.0) if front else (0.0, most * on(t))

        return replace(p, motor=pair, motor_share=share)

    return Hidden(car=car)


def tried(job: tuple[str, int, int, float, bool, bool]) -> list[Row]:
    """All stops of one car: (kind, seed, car, torque, front, ramp)."""
    kind, seed, number, torque, front, ramp = job
    hidden = motor(kind, torque, front, ramp)
    of = case(np.random.default_rng([seed, number]), 3, 1000 * seed + number, hidden)
    return [row for keep_v in (True, False) for row in rows(kind, of, keep_v)]


def main() -> None:
    """Run the study."""
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("--cars", type=int, default=5)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--torque", type=float, default=80.0, metavar="N*M")
    parser.add_argument("--axle", choices=("front", "rear"), default="front")
    parser.add_argument("--ramp", action="store_true", help="the motor brakes on the ramp, too")
    asked = parser.parse_args()
    how = (asked.torque, asked.axle == "front", asked.ramp)
    jobs = [(kind, asked.seed, i, *how) for kind in KINDS for i in range(asked.cars)]
    found = [row for part in carried_out(tried, jobs, asked.jobs) for row in part]
    print(
        f"{asked.torque:g} N m a wheel, {asked.axle}, {asked.cars} cars a kind, seed {asked.seed}"
    )
    for with_v in (True, False):
        printed(found, list(KINDS), with_v)


if __name__ == "__main__":
    main()

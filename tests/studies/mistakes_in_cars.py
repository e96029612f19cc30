"""Mistakes of the vehicle file, and of what the car, its driver or its road do in some runs."""

import math
from dataclasses import replace

import numpy as np

from calib.base.names import WHEELS
from calib.car.vehicle import Axle, Vehicle
from calib.logs.log import Log
from tests.studies.made_lines import BAR, RUNS, STOPS, Run
from tests.studies.mistake import (
    Logs,
    Make,
    Mistake,
    Rng,
    in_car,
    in_channel,
    in_file,
    in_runs,
    off_by,
    percent,
)
from tests.support.plant import Plant, Pressure


def file_value(name: str, low: float, high: float) -> Make:
    """A value of the chassis too high or too low."""

    def make(rng: Rng) -> Mistake:
        k = off_by(rng, low, high)
        return Mistake(
            percent(k), line=in_file(lambda car: replace(car, **{name: k * getattr(car, name)}))
        )

    return make


def too_high(rng: Rng) -> Mistake:
    k = 1.0 + float(rng.uniform(0.1, 0.4))
    return Mistake(percent(k), line=in_file(lambda c: replace(c, cg_height=k * c.cg_height)))


def axle_value(name: str, low: float, high: float, axles: tuple[str, ...]) -> Make:
    """A value of all ``axles``, or of one of them drawn, too high or too low."""

    def make(rng: Rng) -> Mistake:
        k = off_by(rng, low, high)
        chosen = axles if len(axles) == 2 else (str(rng.choice(["front", "rear"])),)

        def change(car: Vehicle) -> Vehicle:
            new = {side: scaled(getattr(car, side), name, k) for side in chosen}
            return replace(car, **new)

        return Mistake(f"{'+'.join(chosen)} {percent(k)}", line=in_file(change))

    return make


def scaled(axle: Axle, name: str, k: float) -> Axle:
    return replace(axle, **{name: k * getattr(axle, name)})


def pads_swapped(rng: Rng) -> Mistake:
    k = off_by(rng, 0.15, 0.40)

    def change(car: Vehicle) -> Vehicle:
        front, rear = (
            scaled(car.front, "pad_friction", k**0.5),
            scaled(car.rear, "pad_friction", k**-0.5),
        )
        return replace(car, front=front, rear=rear)

    return Mistake(f"ratio {percent(k)}", line=in_file(change))


def heavier(rng: Rng) -> Mistake:
    k = 1.0 + float(rng.uniform(0.05, 0.2))
    return Mistake(percent(k), line=in_car(STOPS, lambda p: replace(p, mass_scale=k)))


def engine(runs: tuple[str, ...]) -> Make:
    def make(rng: Rng) -> Mistake:
        torque, front = float(rng.uniform(60.0, 200.0)), bool(rng.random() < 0.7)
        pair = (-2.0 * torque, 0.0) if front else (0.0, -2.0 * torque)
        change = in_car(runs, lambda p: replace(p, motor=lambda t: pair))
        return Mistake(f"{'front' if front else 'rear'} {torque:.0f} N m", line=change)

    return make


def regeneration(rng: Rng) -> Mistake:
    torque, front = float(rng.uniform(40.0, 200.0)), bool(rng.random() < 0.5)

    def change(run: Run) -> Run:
        def motor(t: float) -> tuple[float, float]:
            now = -2.0 * torque * min(max(run.pressure(t) / (3.0 * BAR), 0.0), 1.0)
            return (now, 0.0) if front else (0.0, now)

        return replace(run, plant=replace(run.plant, motor=motor))

    return Mistake(f"{'front' if front else 'rear'} {torque:.0f} N m", line=in_runs(STOPS, change))


def rear_tyres(rng: Rng) -> Mistake:
    k = off_by(rng, 0.10, 0.20)
    change = in_car(RUNS, lambda p: replace(p, rear_stiffness=k * p.rear_stiffness))
    return Mistake(percent(k), line=change)


def tyres_changed(rng: Rng) -> Mistake:
    k, front = off_by(rng, 0.10, 0.20), bool(rng.random() < 0.5)

    def change(p: Plant) -> Plant:
        if front:
            return replace(p, surface=lambda x: (k, 1.0), rear_stiffness=p.rear_stiffness / k)
        return replace(p, rear_stiffness=k * p.rear_stiffness)

    return Mistake(f"{'front' if front else 'rear'} {percent(k)}", line=in_car(STOPS, change))


def bend(runs: tuple[str, ...]) -> Make:
    def make(rng: Rng) -> Mistake:
        sideways = float(rng.choice([-1.0, 1.0]) * rng.uniform(1.5, 5.0))

        def change(run: Run) -> Run:
            k = sideways / run.speed**2
            return replace(run, plant=replace(run.plant, curvature=lambda t: k))

        return Mistake(f"{sideways:+.1f} m/s^2 at first", line=in_runs(runs, change))

    return make


def slope(runs: tuple[str, ...]) -> Make:
    def make(rng: Rng) -> Mistake:
        k = float(rng.choice([-1.0, 1.0]) * rng.uniform(0.02, 0.04))
        change = in_car(runs, lambda p: replace(p, grade=p.grade + k))
        return Mistake(f"{100 * k:+.1f} %", line=change)

    return make


def rear_held(rng: Rng) -> Mistake:
    """Brake control lets the rear have a share of what goes past a pressure."""
    knee, share = float(rng.uniform(8.0, 15.0)) * BAR, float(rng.uniform(0.0, 0.5))

    def change(run: Run) -> Run:
        def rear(t: float) -> float:
            p = run.pressure(t)
            return p if p < knee else knee + share * (p - knee)

        return replace(run, wheels={**run.wheels, "rl": rear, "rr": rear})

    return Mistake(f"past {knee / BAR:.0f} bar {100 * share:.0f} %", line=in_runs(STOPS, change))


def dragging(runs: tuple[str, ...]) -> Make:
    def make(rng: Rng) -> Mistake:
        rest, wheel = float(rng.uniform(2.0, 6.0)) * BAR, str(rng.choice(WHEELS))

        def change(run: Run) -> Run:
            held: Pressure = lambda t: max(run.pressure(t), rest)  # noqa: E731
            return replace(run, wheels={**run.wheels, wheel: held})

        return Mistake(f"{wheel} {rest / BAR:.1f} bar", line=in_runs(runs, change))

    return make


def abs_in_ramp(rng: Rng) -> Mistake:
    """ABS holds the front brakes at what the road bears and lets their wheels dip 5 times a second.

    The dips are drawn as half sine waves of slip, as they look in a log.
    """
    share, depth = float(rng.uniform(0.6, 0.8)), float(rng.uniform(0.08, 0.20))

    def change(run: Run) -> Run:
        most = share * run.pressure(run.duration)
        held: Pressure = lambda t: min(run.pressure(t), most)  # noqa: E731
        return replace(run, wheels={"fl": held, "fr": held})

    def dipped(x: np.ndarray, log: Log) -> np.ndarray:
        works = log["p_mc"] > share * log["p_mc"].max()
        return x * (1.0 - depth * works * np.maximum(np.sin(2.0 * math.pi * 5.0 * log.time), 0.0))

    def logs(of: Logs) -> Logs:
        for wheel in ("omega_fl", "omega_fr"):
            of = in_channel(("ramp",), wheel, dipped)(of)
        return of

    return Mistake(f"{100 * depth:.0f} % slip", line=in_runs(("ramp",), change), logs=logs)

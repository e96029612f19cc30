"""Ramps and stops of the reference car (Tables I and II) in the independent plant."""

import math
from dataclasses import replace
from pathlib import Path

import numpy as np

from calib.car.effects.effects import Effects
from calib.car.vehicle import Vehicle
from calib.car.vehicle_file import read_vehicle
from calib.estimation.estimator import Estimate
from calib.logs.log import Log
from calib.model.ramp import RampRun, prepare
from calib.model.sensor_noise import add_noise
from calib.run.run import Run
from tests.support.plant import WHEELS, Plant, as_log, drive, magic

SEDAN = Path(__file__).parents[2] / "sample_logs/sedan"
CAR = replace(read_vehicle(SEDAN / "vehicle.toml"), mass_tolerance=0.005)
"""Its mass was weighed: 0.5 %."""

IDEAL = Plant(CAR, tyre=magic(25.0, 0.9))
"""What the paper's equations describe: no drag, no rolling resistance, exact radii."""

REAL = replace(IDEAL, drag_area=0.66, rolling_resistance=0.011, radius_scale=(1.0, 1.0008))
"""The same car with what every car has besides."""


def with_pads(plant: Plant, front: float, rear: float) -> Plant:
    """The plant with constant pads [1]."""
    return replace(plant, pads=lambda t: (front, rear))


WET = with_pads(REAL, 0.31, 0.27)
"""It with wet pads, the rear ones more."""


def with_ratio(plant: Plant, ratio: float) -> Plant:
    """The plant with pads in ``ratio`` front over rear, their geometric mean nominal."""
    half = math.sqrt(ratio)
    return with_pads(plant, CAR.front.pad_friction * half, CAR.rear.pad_friction / half)


def balanced(car: Vehicle, z: float) -> Vehicle:
    """The car with rear pistons that brake as hard for their load as the front ones at ``z`` [1].

    The front share of the brake force is then that of the load: it is front-biased below ``z``.
    """
    share = (car.cg_to_rear_axle + z * car.cg_height) / car.wheelbase
    front, rear = (
        a.torque_gain * a.pad_friction / a.rolling_radius / a.piston_area
        for a in (car.front, car.rear)
    )
    area = car.front.piston_area * front / rear * (1.0 - share) / share
    return replace(car, rear=replace(car.rear, piston_area=area))


def ramp(plant: Plant = IDEAL, slope: float = 5e5, name: str = "ramp") -> Log:
    """A ramp of ``slope`` [Pa/s] for 8 s after 1.5 s of rolling, from 33 m/s; 5e5 makes 0.57 g."""
    run = drive(plant, lambda t: slope * max(t - 1.5, 0.0), 33.0, duration=9.5, stop_speed=8.0)
    return as_log(run, name)


SLOPE = {"f": 5e5, "r": 8e5}
"""Rise of the pressure [Pa/s]: to 0.43 g with the front axle, to 0.19 g with the rear one."""


def one_axle(plant: Plant, axle: str, faster: float = 1.0, other: float = 0.0) -> Log:
    """A ramp with the brakes of one axle, wheel pressures logged.

    ``faster`` is a factor on the slope [1], ``other`` the pressure of the other axle [Pa].
    """

    def pressure(t: float) -> float:
        return faster * SLOPE[axle] * max(t - 1.5, 0.0)

    wheel_traces = {w: pressure if w[0] == axle else lambda t: other for w in WHEELS}
    run = drive(plant, pressure, 33.0, duration=9.5, stop_speed=8.0, wheel_pressure=wheel_traces)
    return as_log(run, f"ramp_{axle}")


def stop(plant: Plant = REAL, pressure: float = 25e5, name: str = "stop", **how: float) -> Log:
    """A stop at ``pressure`` [Pa], applied within 0.25 s after 1.5 s of rolling, from 27 m/s."""
    how = {"duration": 9.0, "stop_speed": 1.5, **how}
    run = drive(plant, lambda t: pressure * min(max((t - 1.5) / 0.25, 0.0), 1.0), 27.0, **how)
    return as_log(run, name)


def covered(
    e: Estimate, front: float = 0.38, rear: float = 0.38, quantity: str = "pads"
) -> list[float]:
    """Shares of the valid samples whose interval holds the truth, front and rear [1].

    ``quantity`` is "change" for the change since the ramp.
    """
    out = []
    for x, true in ((f"{quantity}_f", front), (f"{quantity}_r", rear)):
        answers = getattr(e.best, x)
        out.append(float(np.mean(((answers.lower <= true) & (true <= answers.upper))[e.valid])))
    return out


def noisy(log: Log, seed: int) -> Log:
    """The log as usual sensors give it."""
    return add_noise(log, seed)


def without(log: Log, *channels: str) -> Log:
    """The log less some channels."""
    return replace(log, channels={k: x for k, x in log.channels.items() if k not in channels})


def cut(log: Log, first: float, last: float = math.inf) -> Log:
    """The samples of the log between two times [s]."""
    keep = (log.time >= first) & (log.time <= last)
    return replace(
        log,
        channels={k: x[keep] for k, x in log.channels.items()},
        truth={k: x[keep] for k, x in log.truth.items()},
    )


def prepared(log: Log, car: Vehicle = CAR, effects: Effects | None = None) -> RampRun:
    """The log as a fit reads it."""
    return prepare(Run(log, car), effects or Effects())


def misread(log: Log, scale: float = 1.0, offset: float = 0.0) -> Log:
    """The log as an accelerometer of another scale [1] and zero [m/s^2] gives it."""
    return replace(log, channels={**log.channels, "a_x": scale * log["a_x"] + offset})


def swapped(log: Log) -> Log:
    """The log with front and rear wheel speeds exchanged."""
    other = {f"omega_{a}{s}": log[f"omega_{b}{s}"] for a, b in ("fr", "rf") for s in "lr"}
    return replace(log, channels={**log.channels, **other})


def rolled(log: Log, duration: float, drift: float) -> Log:
    """The log after ``duration`` [s] of rolling as at its begin, in which the rear wheels come to
    turn faster by ``drift`` [1], evenly, as when the front tyres warm."""
    count = round(duration / log.sample_time)
    channels = {k: np.concatenate([np.full(count, x[0]), x]) for k, x in log.channels.items()}
    channels["time"] = log.sample_time * np.arange(count + log.time.size)
    for wheel in ("rl", "rr"):
        channels[f"omega_{wheel}"] *= 1.0 + drift * np.minimum(channels["time"] / duration, 1.0)
    truth = {k: np.concatenate([np.full(count, x[0]), x]) for k, x in log.truth.items()}
    return replace(log, channels=channels, truth=truth)


def true_forces(log: Log) -> tuple[np.ndarray, np.ndarray]:
    """F_f, F_r [1] from the plant's tyre forces and wheel loads."""
    front, rear = (
        (log.truth[f"true_Fx_{a}l"] + log.truth[f"true_Fx_{a}r"])
        / (log.truth[f"true_Fz_{a}l"] + log.truth[f"true_Fz_{a}r"])
        for a in "fr"
    )
    return front, rear


def true_eta(log: Log, plant: Plant) -> np.ndarray:
    """Eta [1] from the slips (19), (20) with the radii as they are; ``log`` without noise."""
    radii = (CAR.front.rolling_radius, CAR.rear.rolling_radius)
    slip_f, slip_r = (
        1.0 - r * scale * 0.5 * (log[f"omega_{a}l"] + log[f"omega_{a}r"]) / log["v"]
        for a, r, scale in zip("fr", radii, plant.radius_scale, strict=True)
    )
    return (1.0 - slip_r) / (1.0 - slip_f)

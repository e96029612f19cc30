"""The twelve runs of a case: eight to learn from, four held out. Pressures, speeds, discs.

What is drawn is the deceleration that a nominal car would reach; the pressure follows from it.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.car.vehicle import Vehicle
from tests.support.hidden.hydraulics import STEP
from tests.support.plant import per_pascal

Array = NDArray[np.float64]
Shape = Callable[[Array], Array]

BITE = 1.5
"""The brake is first touched at this time [s]; sooner in ``release``, later in ``mixed``."""

CALIBRATION = (
    "coast",
    "coast_slow",
    "hot",
    "ramp",
    "ramp_fast",
    "release",
    "step_high",
    "step_low",
)
HOLDOUT = ("hot_stop", "mixed", "stop_a", "stop_b")

SPEED = {
    "coast": (27.0, 33.0),
    "coast_slow": (10.8, 12.6),
    "hot": (33.5, 38.5),
    "ramp": (30.0, 35.5),
    "ramp_fast": (24.5, 28.5),
    "release": (31.5, 37.0),
    "step_high": (28.5, 34.0),
    "step_low": (22.0, 26.0),
    "hot_stop": (33.0, 39.0),
    "mixed": (31.4, 37.0),
    "stop_a": (27.0, 31.7),
    "stop_b": (29.0, 35.2),
}
"""Speed at the start [m/s]."""

TEMPERATURE = {
    "coast": 40.0,
    "coast_slow": 40.0,
    "hot": 320.0,
    "ramp": 60.0,
    "ramp_fast": 80.0,
    "release": 120.0,
    "step_high": 180.0,
    "step_low": 100.0,
    "hot_stop": 300.0,
    "mixed": 90.0,
    "stop_a": 70.0,
    "stop_b": 150.0,
}
"""Of all discs at the start [degC]."""

LEVEL = {
    "hot": (0.345, 0.397),
    "step_high": (0.363, 0.430),
    "step_low": (0.145, 0.168),
    "hot_stop": (0.384, 0.462),
    "stop_a": (0.280, 0.322),
    "release": (0.225, 0.262),
    "mixed": (0.280, 0.324),
}
"""Nominal deceleration over g where the pressure is held [1]."""

PULSES = {"release": (1.0, 5.0, 9.0), "mixed": (3.5, 6.2, 8.9)}
"""When the brake is applied again [s]; held for 2 s and for 1.5 s."""


@dataclass(frozen=True)
class Manoeuvre:
    """Name, speed [m/s] and disc temperature [degC] at the start, master pressure every ms [Pa]."""

    name: str
    v0: float
    temperature: float
    pressure: Array


def manoeuvre(name: str, vehicle: Vehicle, rng: np.random.Generator) -> Manoeuvre:
    """Draw one run."""
    shape, duration = SHAPES.get(name, held)(name, rng)
    time = np.arange(round(duration / STEP) + 1) * STEP
    pressure = shape(time) / per_pascal(vehicle)
    return Manoeuvre(name, float(rng.uniform(*SPEED[name])), TEMPERATURE[name], pressure)


def coast(name: str, rng: np.random.Generator) -> tuple[Shape, float]:
    """No brake."""
    duration = rng.uniform(8.5, 9.85) if name == "coast" else rng.uniform(6.3, 7.7)
    return np.zeros_like, round(float(duration), 2)


def held(name: str, rng: np.random.Generator) -> tuple[Shape, float]:
    """One step, held."""
    level = rng.uniform(*LEVEL[name])
    return lambda t: level * smoothstep((t - BITE) / 0.25), 9.745


def ramp(name: str, rng: np.random.Generator) -> tuple[Shape, float]:
    """A straight rise, to the end or held for a second."""
    fast = name == "ramp_fast"
    slope = rng.uniform(0.131, 0.176) if fast else rng.uniform(0.064, 0.081)
    top = rng.uniform(0.41, 0.465) if fast else rng.uniform(0.475, 0.525)
    duration = BITE + top / slope + (1.0 if fast else 0.0)
    return lambda t: np.clip(slope * (t - BITE), 0.0, top), round(float(duration), 2)


def pulses(name: str, rng: np.random.Generator) -> tuple[Shape, float]:
    """Applied and released three times."""
    level = rng.uniform(*LEVEL[name])
    hold = 2.0 if name == "release" else 1.5

    def shape(t: Array) -> Array:
        on = [
            smoothstep((t - s) / 0.15) - smoothstep((t - s - hold + 0.15) / 0.15)
            for s in PULSES[name]
        ]
        return np.asarray(level * np.sum(on, axis=0))

    return shape, 12.995 if name == "release" else 11.595


def wave(name: str, rng: np.random.Generator) -> tuple[Shape, float]:
    """A pressure that swings about its mean."""
    level, swing, f = rng.uniform(0.248, 0.272), rng.uniform(0.31, 0.38), rng.uniform(0.555, 0.645)

    def shape(t: Array) -> Array:
        rise = np.clip((t - BITE) / 0.4, 0.0, 1.0)
        return np.asarray(level * rise * (1.0 + swing * np.sin(2.0 * np.pi * f * (t - BITE))))

    return shape, 9.495


SHAPES: dict[str, Callable[[str, np.random.Generator], tuple[Shape, float]]] = {
    "coast": coast,
    "coast_slow": coast,
    "ramp": ramp,
    "ramp_fast": ramp,
    "release": pulses,
    "mixed": pulses,
    "stop_b": wave,
}


def smoothstep(x: Array) -> Array:
    """0 below 0, 1 above 1, a cubic between."""
    x = np.clip(x, 0.0, 1.0)
    return np.asarray(x * x * (3.0 - 2.0 * x))

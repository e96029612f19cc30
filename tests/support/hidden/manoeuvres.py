"""The twelve runs of a case: eight to learn from, four held out. Pressures, speeds, discs.

What is drawn is the deceleration that a nominal car would reach; the pressure follows from it.
"""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.car.vehicle import Vehicle
from tests.support.hidden.hydraulics import STEP
from tests.support.plant import per_pascal

Shape = Callable[[Array], Array]
Range = tuple[float, float]

BITE = 1.5
"""The brake is first touched at this time [s]; sooner in ``release``, later in ``mixed``."""

FREE = (0.0, 0.0)
"""The level of a run whose pressure is not held."""

PULSES = {"release": ((1.0, 5.0, 9.0), 2.0, 12.995), "mixed": ((3.5, 6.2, 8.9), 1.5, 11.595)}
"""When the brake is applied again, for how long, and when the run ends [s]."""


@dataclass(frozen=True)
class Manoeuvre:
    """Name, speed [m/s] and disc temperature [degC] at the start, master pressure every ms [Pa]."""

    name: str
    v0: float
    temperature: float
    pressure: Array


def manoeuvre(name: str, vehicle: Vehicle, rng: np.random.Generator) -> Manoeuvre:
    """Draw one run."""
    drawn, speeds, temperature, level = RUNS[name]
    shape, duration = drawn(name, level, rng)
    time = np.arange(round(duration / STEP) + 1) * STEP
    pressure = shape(time) / per_pascal(vehicle)
    return Manoeuvre(name, float(rng.uniform(*speeds)), temperature, pressure)


def coast(name: str, level: Range, rng: np.random.Generator) -> tuple[Shape, float]:
    """No brake."""
    duration = rng.uniform(8.5, 9.85) if name == "coast" else rng.uniform(6.3, 7.7)
    return np.zeros_like, round(float(duration), 2)


def constant(name: str, level: Range, rng: np.random.Generator) -> tuple[Shape, float]:
    """One step, held."""
    z = rng.uniform(*level)
    return lambda t: z * smoothstep((t - BITE) / 0.25), 9.745


def ramp(name: str, level: Range, rng: np.random.Generator) -> tuple[Shape, float]:
    """A straight rise, to the end or held for a second."""
    fast = name == "ramp_fast"
    slope = rng.uniform(0.131, 0.176) if fast else rng.uniform(0.064, 0.081)
    top = rng.uniform(0.41, 0.465) if fast else rng.uniform(0.475, 0.525)
    duration = BITE + top / slope + (1.0 if fast else 0.0)
    return lambda t: np.clip(slope * (t - BITE), 0.0, top), round(float(duration), 2)


def pulses(name: str, level: Range, rng: np.random.Generator) -> tuple[Shape, float]:
    """Applied and released three times."""
    z = rng.uniform(*level)
    starts, hold, end = PULSES[name]

    def shape(t: Array) -> Array:
        on = [smoothstep((t - s) / 0.15) - smoothstep((t - s - hold + 0.15) / 0.15) for s in starts]
        return np.asarray(z * np.sum(on, axis=0))

    return shape, end


def wave(name: str, level: Range, rng: np.random.Generator) -> tuple[Shape, float]:
    """A pressure that swings about its mean."""
    z, swing, f = rng.uniform(*level), rng.uniform(0.31, 0.38), rng.uniform(0.555, 0.645)

    def shape(t: Array) -> Array:
        rise = np.clip((t - BITE) / 0.4, 0.0, 1.0)
        return np.asarray(z * rise * (1.0 + swing * np.sin(2.0 * np.pi * f * (t - BITE))))

    return shape, 9.495


RUNS: dict[str, tuple[Callable[..., tuple[Shape, float]], Range, float, Range]] = {
    "coast": (coast, (27.0, 33.0), 40.0, FREE),
    "coast_slow": (coast, (10.8, 12.6), 40.0, FREE),
    "hot": (constant, (33.5, 38.5), 320.0, (0.345, 0.397)),
    "ramp": (ramp, (30.0, 35.5), 60.0, FREE),
    "ramp_fast": (ramp, (24.5, 28.5), 80.0, FREE),
    "release": (pulses, (31.5, 37.0), 120.0, (0.225, 0.262)),
    "step_high": (constant, (28.5, 34.0), 180.0, (0.363, 0.430)),
    "step_low": (constant, (22.0, 26.0), 100.0, (0.145, 0.168)),
    "hot_stop": (constant, (33.0, 39.0), 300.0, (0.384, 0.462)),
    "mixed": (pulses, (31.4, 37.0), 90.0, (0.280, 0.324)),
    "stop_a": (constant, (27.0, 31.7), 70.0, (0.280, 0.322)),
    "stop_b": (wave, (29.0, 35.2), 150.0, (0.248, 0.272)),
}
"""Shape, speed [m/s] and temperature of all discs [degC] at the start, and the nominal
deceleration over g where the pressure is held [1]."""

CALIBRATION, HOLDOUT = tuple(RUNS)[:8], tuple(RUNS)[8:]


def smoothstep(x: Array) -> Array:
    """0 below 0, 1 above 1, a cubic between."""
    x = np.clip(x, 0.0, 1.0)
    return np.asarray(x * x * (3.0 - 2.0 * x))

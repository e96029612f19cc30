"""Manoeuvres for the simulation: brake pressure over time from a first speed.

    ramp ____/    step ___|----    stop ___/---    wave ___~~~~

Every manoeuvre begins with an unbraked lead-in, where eta can be zeroed; `coast` is nothing else.
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ModelError

LEAD_IN = 1.5  # unbraked time at the start [s]

_RISE = 400e5
"""Rise of the pressure in a step [Pa/s], as a real master cylinder limits it; a driver in an
emergency reaches 60 bar in 0.15 s."""

_FOOT = 80e5  # rise of the pressure in a usual stop [Pa/s]: a foot reaches 30 bar in about 0.4 s
_SLOPE = 5e5  # rise of a ramp [Pa/s]: from 33 m/s the sedan of the paper stops before 50 bar
_HOLD = 1.0  # time for which a ramp keeps its last pressure [s]
_SWING, _FREQUENCY = 0.4, 0.7  # amplitude over the mean pressure [1] and frequency [Hz] of a wave
_RATES = (40.0, 1000.0)  # lowest and highest sample rate of the program [Hz]
_LONGEST = 600.0  # longest time of a manoeuvre [s]


_USUAL = {
    "ramp": (60e5, 60e5 / _SLOPE),
    "step": (30e5, 20.0),
    "stop": (30e5, 60.0),
    "wave": (25e5, 20.0),
    "coast": (0.0, 20.0),
}
"""Pressure [Pa] and time [s] where none is given."""

NAMES = tuple(_USUAL)


def manoeuvre(
    name: str,
    v0: float,
    pressure: float | None = None,
    rate: float = 200.0,
    duration: float | None = None,
) -> tuple[Array, Array]:
    """Return time [s] and pressure [Pa] (n,) of the manoeuvre of that name, from ``v0`` [m/s].

    It has ``rate`` samples a second. ``duration`` [s] is the time of the rise of a ramp, the length
    of a coast, and the time at ``pressure`` [Pa] of the others. Raises ModelError for an unknown
    name, a pressure for `coast`, and numbers that cannot be driven.
    """
    if name not in NAMES:
        raise ModelError(f"unknown manoeuvre {name!r}", expected=f"one of {', '.join(NAMES)}")
    if name == "coast" and pressure is not None:
        raise ModelError("coast takes no pressure", do="leave the pressure out")
    if not _RATES[0] <= rate <= _RATES[1]:
        expected = f"{_RATES[0]:g} to {_RATES[1]:g} Hz"
        raise ModelError(f"sample rate {rate:g} Hz", where=name, expected=expected)
    for quantity, value, unit in (
        ("pressure", pressure, "Pa"), ("first speed", v0, "m/s"), ("duration", duration, "s"),
    ):  # fmt: skip
        if value is not None and not 0.0 < value < np.inf:
            raise ModelError(f"{quantity} {value:g} {unit}", where=name, expected="more than zero")
    if duration is not None and duration > _LONGEST:
        expected = f"up to {_LONGEST:g} s"
        raise ModelError(f"duration {duration:g} s", where=name, expected=expected)
    usual, time = _USUAL[name]
    level = usual if pressure is None else pressure
    if duration is None:
        duration = level / _SLOPE if name == "ramp" else time
    corners, levels = np.array(_corners(name, level, duration)).T
    clock = np.arange(int(np.floor(corners[-1] * rate + 1e-9)) + 1) / rate
    trace = np.interp(clock, corners, levels)
    if name == "wave":
        phase = 2.0 * np.pi * _FREQUENCY * np.maximum(clock - LEAD_IN - level / _RISE, 0.0)
        trace *= 1.0 + _SWING * np.sin(phase)
    return clock, trace


def _corners(name: str, pressure: float, duration: float) -> list[tuple[float, float]]:
    """Time [s] and pressure [Pa] at the ends of straight lines."""
    if name == "coast":
        return [(0.0, 0.0), (duration, 0.0)]
    rise, hold = pressure / (_FOOT if name == "stop" else _RISE), duration
    if name == "ramp":
        rise, hold = duration, _HOLD
    top = LEAD_IN + rise
    return [(LEAD_IN, 0.0), (top, pressure), (top + hold, pressure)]

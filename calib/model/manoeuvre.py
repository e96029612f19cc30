"""Manoeuvres for the simulation: brake pressure over time.

    ramp ____/    step ___|----    stop ___/---    wave ___~~~~

Every manoeuvre begins with an unbraked lead-in, where eta can be zeroed; `coast` is nothing else.
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ModelError

LEAD_IN = 1.5  # unbraked time at the start [s]
RATE = 200.0  # samples per second

_RISE = 400e5
"""Rise of the pressure in a step [Pa/s], as a real master cylinder limits it; a driver in an
emergency reaches 60 bar in 0.15 s."""

_SLOPE = 5e5  # rise of a ramp [Pa/s]: from 33 m/s the sedan of the paper stops before 50 bar
_FOOT = 80e5  # rise of the pressure in a usual stop [Pa/s]: a foot reaches 30 bar in about 0.4 s
_SWING, _FREQUENCY = 0.4, 0.7  # amplitude over the mean pressure [1] and frequency [Hz] of a wave

_USUAL = {
    "ramp": (60e5, _SLOPE, 1.0),
    "step": (30e5, _RISE, 20.0),
    "stop": (30e5, _FOOT, 60.0),
    "wave": (25e5, _RISE, 20.0),
    "coast": (0.0, _RISE, 20.0 - LEAD_IN),
}
"""Pressure [Pa] where none is given, its rise [Pa/s], and the time for which it is held [s]."""

NAMES = tuple(_USUAL)


def manoeuvre(name: str, pressure: float | None = None) -> tuple[Array, Array]:
    """Return time [s] and pressure [Pa] (n,) of a manoeuvre, at its usual ``pressure`` by default.

    Raises ModelError for an unknown name, a pressure for `coast`, and one that is not above zero.
    """
    if name not in NAMES:
        raise ModelError(f"unknown manoeuvre {name!r}", expected=f"one of {', '.join(NAMES)}")
    usual, rise, hold = _USUAL[name]
    if pressure is not None and (name == "coast" or not 0.0 < pressure < np.inf):
        expected = "no pressure" if name == "coast" else "more than zero"
        raise ModelError(f"pressure {pressure:g} Pa", where=name, expected=expected)
    level = usual if pressure is None else pressure
    top = LEAD_IN + level / rise
    time = np.arange(int(np.floor((top + hold) * RATE + 1e-9)) + 1) / RATE
    trace = np.interp(time, [LEAD_IN, top], [0.0, level])
    if name == "wave":
        phase = 2.0 * np.pi * _FREQUENCY * np.maximum(time - top, 0.0)
        trace *= 1.0 + _SWING * np.sin(phase)
    return time, trace

"""Manoeuvres for the simulation: brake pressure over time.

    ramp ____/    step ___|----    stop ___/---    wave ___~~~~    coast _______

Every manoeuvre begins with an unbraked lead-in, on which eta can be zeroed.
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ModelError

LEAD_IN = 1.5  # unbraked time at the start [s]

# Rise of the pressure [Pa/s]. Step: a driver in an emergency reaches 60 bar in 0.15 s. Stop: a foot
# reaches 30 bar in about 0.4 s. Ramp: from 33 m/s the sedan of the paper stops before 50 bar.
_STEP_RATE, _STOP_RATE, _RAMP_RATE = 400e5, 80e5, 5e5
_HOLD = 1.0  # time for which a ramp keeps its last pressure [s]
_SWING, _FREQUENCY = 0.4, 0.7  # amplitude over the mean pressure [1] and frequency [Hz] of a wave

_DEFAULTS = {
    "ramp": (60e5, _RAMP_RATE, _HOLD),
    "step": (30e5, _STEP_RATE, 20.0),
    "stop": (30e5, _STOP_RATE, 60.0),
    "wave": (25e5, _STEP_RATE, 20.0),
    "coast": (0.0, _STEP_RATE, 20.0),
}
"""Default pressure [Pa], its rise [Pa/s], and the time at it [s] (of a `coast`, the whole time)."""

_BOUNDS = {"pressure": (1.0, 3e7, "Pa"), "rate": (40.0, 1e3, "Hz"), "duration": (1e-3, 600.0, "s")}
"""Least and largest value of each argument, with its unit."""

NAMES = tuple(_DEFAULTS)


def manoeuvre(
    name: str, pressure: float | None = None, rate: float = 200.0, duration: float | None = None
) -> tuple[Array, Array]:
    """Return time [s] and pressure [Pa], (n,) each, of the manoeuvre ``name`` of `NAMES`.

    ``rate`` is that of the samples [Hz]. ``duration`` [s] is the time of the rise of a ramp, the
    length of a coast, and the time at ``pressure`` [Pa] of the other manoeuvres. Raises ModelError
    for an unknown name, a pressure for `coast`, and numbers outside `_BOUNDS`.
    """
    if name not in NAMES:
        raise ModelError(f"unknown manoeuvre {name!r}", expected=f"one of {', '.join(NAMES)}")
    if name == "coast" and pressure is not None:
        raise ModelError("coast takes no pressure", do="leave the pressure out")
    quantities = {"pressure": pressure, "rate": rate, "duration": duration}
    for quantity, (low, high, unit) in _BOUNDS.items():
        value = quantities[quantity]
        if value is not None and not low <= value <= high:
            expected = f"{low:g} to {high:g} {unit}"
            raise ModelError(f"{quantity} {value:g} {unit}", where=name, expected=expected)
    default_pressure, slope, hold = _DEFAULTS[name]
    plateau = default_pressure if pressure is None else pressure
    rise_time = plateau / slope
    if duration is not None and name == "ramp":
        rise_time = duration
    elif duration is not None:
        hold = duration
    top = LEAD_IN + rise_time
    end = hold if name == "coast" else top + hold
    time = np.arange(int(np.floor(end * rate + 1e-9)) + 1) / rate
    trace = np.interp(time, [LEAD_IN, top], [0.0, plateau])
    if name == "wave":
        phase = 2.0 * np.pi * _FREQUENCY * np.maximum(time - top, 0.0)
        trace *= 1.0 + _SWING * np.sin(phase)
    return time, trace

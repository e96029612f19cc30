"""Manoeuvres for the simulation: brake pressure over time from a first speed.

    ramp ____/    step ___|----    stop ___/---    wave ___~~~~    staircase ___.-'-'

Every manoeuvre begins with an unbraked lead-in, where eta can be zeroed; `coast` is nothing else.
All pressures are in Pa. `RISE` limits the slope of a step, as in a real master cylinder.
"""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import ModelError

RISE = 400e5
"""Rise of the pressure in a step [Pa/s]; a driver in an emergency reaches 60 bar in 0.15 s."""

_FOOT = 80e5
"""Rise of the pressure in a usual stop [Pa/s]: a foot reaches 30 bar in about 0.4 s."""

LEAD_IN = 1.5
"""Unbraked time at the start [s]."""

_RATES = (40.0, 1000.0)
"""Lowest and highest sample rate [Hz] of the program."""


@dataclass(frozen=True)
class Manoeuvre:
    """Pressure [Pa] at time [s], both (n,), to be driven from ``v0`` [m/s]."""

    name: str
    time: Array
    pressure: Array
    v0: float


RAMP = 60e5
"""Pressure at the end of a ramp [Pa]."""

STEPS = 5
"""Steps of a staircase."""


def ramp(
    v0: float,
    pressure: float = RAMP,
    rate: float = 200.0,
    *,
    slope: float = 5e5,
    lead_in: float = LEAD_IN,
    hold: float = 1.0,
) -> Manoeuvre:
    """Rise by ``slope`` [Pa/s] to ``pressure`` [Pa], kept for ``hold`` [s]: the calibration run.

    From 33 m/s, the sedan of the paper stops before a slope of 5 bar/s reaches 50 bar.
    """
    top = lead_in + pressure / slope
    return _trace("ramp", v0, rate, [(lead_in, 0.0), (top, pressure), (top + hold, pressure)])


def step(
    v0: float,
    pressure: float = 30e5,
    rate: float = 200.0,
    *,
    lead_in: float = LEAD_IN,
    hold: float = 20.0,
) -> Manoeuvre:
    """Step to ``pressure`` [Pa] after the lead-in, kept for ``hold`` [s]."""
    top = lead_in + pressure / RISE
    return _trace("step", v0, rate, [(lead_in, 0.0), (top, pressure), (top + hold, pressure)])


def stop(
    v0: float,
    pressure: float = 30e5,
    rate: float = 200.0,
    *,
    lead_in: float = LEAD_IN,
    duration: float = 60.0,
) -> Manoeuvre:
    """Rise to ``pressure`` [Pa] as a foot does, kept for ``duration`` [s], until the car stops."""
    top = lead_in + pressure / _FOOT
    return _trace("stop", v0, rate, [(lead_in, 0.0), (top, pressure), (top + duration, pressure)])


def wave(
    v0: float,
    pressure: float = 25e5,
    rate: float = 200.0,
    *,
    amplitude: float = 0.4,
    frequency: float = 0.7,
    lead_in: float = LEAD_IN,
    duration: float = 20.0,
) -> Manoeuvre:
    """Mean ``pressure`` [Pa], modulated by ``amplitude`` [1] of it with ``frequency`` [Hz].

    Raises ModelError if the amplitude is not below 1: the pressure would be negative.
    """
    if not 0.0 <= amplitude < 1.0:
        raise ModelError(f"amplitude {amplitude:g}", where="wave", expected="0 to below 1")
    top = lead_in + pressure / RISE
    mean = _trace("wave", v0, rate, [(lead_in, 0.0), (top, pressure), (top + duration, pressure)])
    phase = 2.0 * np.pi * frequency * np.maximum(mean.time - top, 0.0)
    return Manoeuvre("wave", mean.time, mean.pressure * (1.0 + amplitude * np.sin(phase)), v0)


def staircase(
    v0: float,
    pressure: float = 40e5,
    rate: float = 200.0,
    *,
    steps: int = STEPS,
    hold: float = 1.5,
    lead_in: float = LEAD_IN,
) -> Manoeuvre:
    """``steps`` equal steps up to ``pressure`` [Pa], each kept for ``hold`` [s]."""
    corners, at = [(lead_in, 0.0)], lead_in
    for level in pressure * np.arange(1, steps + 1) / steps:
        foot = (at, corners[-1][1])
        at += pressure / steps / RISE
        corners += [foot, (at, float(level)), (at + hold, float(level))]
        at += hold
    return _trace("staircase", v0, rate, corners)


def coast(v0: float, rate: float = 200.0, *, duration: float = 20.0) -> Manoeuvre:
    """No pressure at all for ``duration`` [s]."""
    return _trace("coast", v0, rate, [(0.0, 0.0), (duration, 0.0)])


BRAKING: dict[str, Callable[..., Manoeuvre]] = {
    "ramp": ramp,
    "step": step,
    "stop": stop,
    "wave": wave,
    "staircase": staircase,
}
"""The manoeuvres that take a pressure, by name."""

NAMES = (*BRAKING, "coast")

LONGEST = 600.0
"""Longest time of a manoeuvre [s]."""


def manoeuvre(
    name: str,
    v0: float,
    pressure: float | None = None,
    rate: float = 200.0,
    duration: float | None = None,
) -> Manoeuvre:
    """Return the manoeuvre of that name; its own pressure [Pa] and time [s] if none is given.

    ``duration`` is the time of the rise of a ramp, that of all steps of a staircase, the length of
    a coast, and the time at pressure of the others. Raises ModelError for an unknown name, a
    pressure for `coast`, a pressure, speed or duration that is not positive, a duration above
    `LONGEST`, and a rate outside `_RATES`.
    """
    if name not in NAMES:
        raise ModelError(f"unknown manoeuvre {name!r}", expected=f"one of {', '.join(NAMES)}")
    if name == "coast" and pressure is not None:
        raise ModelError("coast takes no pressure", do="leave the pressure out")
    if pressure is not None and not 0.0 < pressure < np.inf:
        raise ModelError(f"pressure {pressure:g} Pa", where=name, expected="more than zero")
    if not 0.0 < v0 < np.inf:
        raise ModelError(f"first speed {v0:g} m/s", where=name, expected="more than zero")
    if duration is not None and not 0.0 < duration <= LONGEST:
        raise ModelError(
            f"duration {duration:g} s", where=name, expected=f"more than zero, up to {LONGEST:g} s"
        )
    given = {} if pressure is None else {"pressure": pressure}
    if duration is not None:
        given |= _lasting(name, pressure, duration)
    return coast(v0, rate, **given) if name == "coast" else BRAKING[name](v0, rate=rate, **given)


def _lasting(name: str, pressure: float | None, duration: float) -> dict[str, float]:
    """The argument that gives a manoeuvre its ``duration`` [s]."""
    if name == "ramp":
        return {"slope": (RAMP if pressure is None else pressure) / duration}
    if name == "staircase":
        return {"hold": duration / STEPS}
    return {"hold" if name == "step" else "duration": duration}


def _trace(name: str, v0: float, rate: float, corners: Sequence[tuple[float, float]]) -> Manoeuvre:
    """Straight lines between (time [s], pressure [Pa]), sampled at ``rate`` [Hz]."""
    if not _RATES[0] <= rate <= _RATES[1]:
        raise ModelError(
            f"sample rate {rate:g} Hz", where=name, expected=f"{_RATES[0]:g} to {_RATES[1]:g} Hz"
        )
    at, level = np.array(corners).T
    time = np.arange(int(np.floor(at[-1] * rate + 1e-9)) + 1) / rate
    return Manoeuvre(name, time, np.interp(time, at, level), v0)

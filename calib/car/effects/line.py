"""Effects of the line, from the master cylinder to the wheels, in the direction of flow."""

import numpy as np

from calib.base.arrays import Array
from calib.car.effects.effect import Pair, Parameters, effect
from calib.car.history import RunHistory
from calib.car.lag import low_pass, second_order


def _delayed(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Linear between samples; outside the log the pressure is that of the nearest sample.

    A ``delay`` below zero is that of a pressure which is logged late against all other channels.
    """
    then = history.time - parameters["delay"]
    return np.interp(then, history.time, p_f), np.interp(then, history.time, p_r)


def _lagging(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """A lag that does not overshoot, the same on both axles; steady state at the first sample.

    q, ``lag_bend``, is 0 where it is not given: first order; 1/4 is two lags of T/2 in a row, more
    would swing. Not valid for a line that fills faster than it empties.
    """
    T = parameters["time_constant"]
    if T <= 0.0:
        return p_f, p_r
    second = parameters.get("lag_bend", 0.0) * T**2
    front = low_pass(history.time, p_f, T, second)
    return front, front if p_r is p_f else low_pass(history.time, p_r, T, second)


def _oscillating(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """A second-order lag that overshoots, the same on both axles; T = 1/w of the undamped mode.

    Steady state at the first sample. It does not swing below zero, where nothing clamps. Not valid
    for a strongly damped line: that is a lag.
    """
    T, damping = parameters["response_time"], parameters["line_damping"]
    if T <= 0.0:
        return p_f, p_r
    front = _swinging(history.time, p_f, 1.0 / T, damping)
    return front, front if p_r is p_f else _swinging(history.time, p_r, 1.0 / T, damping)


def _swinging(time: Array, p: Array, frequency: float, damping: float) -> Array:
    return np.maximum(second_order(time, p, frequency, damping), np.minimum(p, 0.0))


def _proportioned(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """For a valve without hysteresis, whose knee does not depend on load or deceleration."""
    return p_f, limited(p_r, parameters["knee"], parameters["knee_slope"])


def limited(p: Array, knee: float, slope: float) -> Array:
    """Pressure [Pa] behind the valve: it grows with ``slope`` [1] above the ``knee`` [Pa]."""
    return np.asarray(p - (1.0 - slope) * np.maximum(p - knee, 0.0))


EFFECTS = (
    effect("hydraulic_delay", pressure=_delayed),
    effect("hydraulic_lag", pressure=_lagging),
    effect("hydraulic_oscillation", pressure=_oscillating),
    effect("rear_proportioning", pressure=_proportioned),
)

"""Effects of the line, from the master cylinder to the wheels, in the direction of flow."""

import numpy as np

from calib.base.arrays import Array
from calib.car.effects.effect import Pair, Parameter, Parameters, effect
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
    effect(
        "hydraulic_delay",
        Parameter("delay", "s", -0.05, 0.5, 0.05, 0.03),
        cause="dead time between the pressure sensor and the brakes, or between their clocks",
        equation="p(t) = p_mc(t - T_d); no effect at delay = 0",
        source="Breuer and Bill, Brake Technology Handbook",
        looks_like="torque that follows the pressure later, with unchanged shape",
        pressure=_delayed,
    ),
    effect(
        "hydraulic_lag",
        Parameter("time_constant", "s", 0.0, 1.0, 0.1, 0.06),
        Parameter("lag_bend", "1", 0.0, 0.25, 0.1, 0.1, default=0.0),
        cause="flow resistance of the lines and volume taken by the calipers",
        equation="q T^2 p'' + T p' + p = p_mc; no effect at time_constant = 0",
        source="Limpert, Brake Design and Safety, ch. 5; Breuer and Bill, Brake Technology",
        looks_like="torque that follows changes of pressure late and rounded; none when held",
        pressure=_lagging,
    ),
    effect(
        "hydraulic_oscillation",
        Parameter("response_time", "s", 0.0, 0.5, 0.06, 0.04),
        Parameter("line_damping", "1", 0.05, 0.98, 0.5, 0.2),
        cause="mass of the fluid in the lines on the compliance of hoses, calipers or a booster",
        equation="T^2 p'' + 2 D T p' + p = p_mc; no effect at response_time = 0",
        source="Limpert, Brake Design and Safety, ch. 5; Breuer and Bill, Brake Technology",
        looks_like="torque that follows a step of pressure late and overshoots; on ramps the "
        "same as a delay of 2 D T: only steps or quick releases tell them apart",
        pressure=_oscillating,
    ),
    effect(
        "rear_proportioning",
        Parameter("knee_slope", "1", 0.0, 1.0, 0.4, 0.2),
        Parameter("knee", "Pa", 0.0, 150e5, 25e5, 10e5),
        cause="a proportioning valve, or a control unit that acts as one",
        equation="p_r = p_k + s (p - p_k) above p_k; no effect at knee_slope = 1",
        source="Limpert, Brake Design and Safety, ch. 7",
        looks_like="rear torque that grows less with pressure above a knee; front unchanged",
        neutral=1.0,
        pressure=_proportioned,
    ),
)

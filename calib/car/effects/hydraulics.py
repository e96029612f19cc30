"""Effects of the brake lines, then of the calipers, each in the order in which they act.

A wheel pressure sensor sits between the two.

Hysteresis by the friction of seals and pins: a play operator between two lines, at any rate of the
pressure.

    clamp ^            .-------.        loading    c = p - r, not below zero
          |          .'      .'         release    c = p/(1 - u) + r
          |        .'      .'           between    c stays
          |      .'      .'
          |    .'      .'               r = s w p_0/2     s w of the width is fixed,
          |    |     .'                 u = (1 - s) w     the rest grows with the pressure
          +----'-----'--------> p

By the fixed part the pads bite late by r, and keep r when the pedal is free. With L = p - r and
U = p/(1 - u) + r at each sample: c[k] = max(L[k], min(U[k], c[k-1])).

Residual torque: pads that do not come back after the first release.

    clamp ^      .------.
          |    .'        '.
        r |  .'            '--...___       min(p, r) of the last application, draining
          +-'------------------------> t
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import QUARTILE
from calib.car.braking import BITE
from calib.car.effects.effect import Pair, Parameters, effect
from calib.car.history import RunHistory
from calib.car.lag import low_pass, second_order

_EQUAL = 0.5
"""Rear share at which both axles have the same threshold [1]."""

_REFERENCE = 20e5
"""Pressure p_0 of a usual stop [Pa], at which the width of the loop is given."""

_MOST_NOISE = 0.25e5
"""Largest assumed noise of a constant pressure [Pa]: three standard deviations of a noisy sensor
(0.4 bar at 200 Hz), averaged over 0.1 s."""


def _delayed(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressures of ``delay`` earlier; negative for a pressure that is logged late."""
    then = history.time - parameters["delay"]
    return np.interp(then, history.time, p_f), np.interp(then, history.time, p_r)


def _lagging(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressures after a lag without overshoot, from steady state at the first sample.

    ``lag_bend`` q is by default 0, first order; 1/4, two lags of T/2 in a row, is the most without
    overshoot. Not valid for a line that fills faster than it empties.
    """
    T = parameters["time_constant"]
    if T <= 0.0:
        return p_f, p_r
    second = parameters.get("lag_bend", 0.0) * T**2
    front = low_pass(history.time, p_f, T, second)
    return front, front if p_r is p_f else low_pass(history.time, p_r, T, second)


def _oscillating(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressures after a second-order lag that overshoots, with T = 1/w of the undamped mode.

    From steady state at the first sample, and not below zero. A strongly damped line is a lag.
    """
    T, damping = parameters["response_time"], parameters["line_damping"]
    if T <= 0.0:
        return p_f, p_r
    front = _swinging(history.time, p_f, 1.0 / T, damping)
    return front, front if p_r is p_f else _swinging(history.time, p_r, 1.0 / T, damping)


def _swinging(time: Array, p: Array, frequency: float, damping: float) -> Array:
    return np.maximum(second_order(time, p, frequency, damping), np.minimum(p, 0.0))


def _proportioned(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressures behind a valve in the rear line, without hysteresis and with a fixed knee."""
    return p_f, limited(p_r, parameters["knee"], parameters["knee_slope"])


def limited(p: Array, knee: float, slope: float) -> Array:
    """Pressure [Pa] behind the valve: it grows with ``slope`` [1] above the ``knee`` [Pa]."""
    return np.asarray(p - (1.0 - slope) * np.maximum(p - knee, 0.0))


def _above_threshold(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressure less the threshold; negative pressures of a noisy sensor keep their sign.

    A negative threshold -p_0 is that of a sensor that reads p_0 too little; below p_0 it adds less,
    so that a released brake stays released.
    """
    share = parameters.get("threshold_rear_share", _EQUAL)
    larger = parameters["threshold"]
    front, rear = larger * min(1.0, 2.0 - 2.0 * share), larger * min(1.0, 2.0 * share)
    return _less(p_f, front), _less(p_r, rear)


def _less(p: Array, threshold: float) -> Array:
    if threshold < 0.0:
        return np.asarray(p + np.minimum(np.abs(p), -threshold))
    return np.asarray(p - np.clip(p, -threshold, threshold))


def _hysteresis(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Clamping pressures of the loop, from the loading line on; the same width on both axles.

    ``fixed_share`` of the width is by default 0. A negative pressure (sensor noise) has no play.
    Not valid for a caliper whose seals pull the pads back.
    """
    width, share = parameters["width"], parameters.get("fixed_share", 0.0)
    loop = ((1.0 - share) * width, 0.5 * share * width * _REFERENCE)
    front = _denoised_loop(p_f, *loop)
    return front, front if p_r is p_f else _denoised_loop(p_r, *loop)


def _denoised_loop(p: Array, relative: float, half: float) -> Array:
    """Clamping pressure, where changes of ``p`` within the band of its noise do not count.

    Otherwise noise would raise the clamp step by step at a constant pressure. Exact without noise;
    with it, between the lines of the loop, low by at most twice the band.
    """
    sigma = np.median(np.abs(np.diff(p, 3))) / QUARTILE if p.size > 3 else 0.0
    band = min(3.0 * float(sigma), _MOST_NOISE)
    steady = _play(p - band, p + band, p[0])
    return np.asarray(p + (hysteresis_loop(steady, relative, half) - steady))


def hysteresis_loop(p: Array, relative: float, half: float = 0.0) -> Array:
    """Clamping pressure [Pa] (n,) at line pressure ``p`` [Pa] (n,).

    ``relative`` u [1] below 1; ``half`` r of the fixed width [Pa].
    """
    loading = p - np.clip(p, 0.0, half)
    return _play(loading, p / (1.0 - relative) + half, loading[0])


def _play(lowest: Array, highest: Array, first: float) -> Array:
    """c[k] = max(lowest[k], min(highest[k], c[k-1])) (n,), from ``first`` on.

    Two limits [L, U] in a row are one limit: log2(n) passes join runs of twice the length each.
    """
    low, high = lowest.copy(), highest.copy()
    low[0] = high[0] = first
    reach = 1
    while reach < low.size:
        joined = np.maximum(low[reach:], np.minimum(high[reach:], low[:-reach]))
        high[reach:] = np.maximum(low[reach:], np.minimum(high[reach:], high[:-reach]))
        low[reach:] = joined
        reach *= 2
    return low


def _residual(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """At least the residual pressure of the last application above `BITE`.

    ``rear_bias`` is 0 if both axles keep it, 1 only the rear one, -1 only the front one. Not valid
    for pads that are knocked back by the disc.
    """
    most, bias = parameters["residual_pressure"], parameters["rear_bias"]
    if most <= 0.0:
        return p_f, p_r
    drain = parameters["drain_time"]
    front = residual_clamp(history.time, p_f, most * min(1.0, 1.0 - bias), drain)
    return front, residual_clamp(history.time, p_r, most * min(1.0, 1.0 + bias), drain)


def residual_clamp(time: Array, p: Array, most: float, drain: float) -> Array:
    """Clamping pressure max(p, r) [Pa] (n,), where r' = -r/drain and r >= min(p, most).

    ``time`` [s], ``p`` [Pa] (n,); ``most`` [Pa], ``drain`` [s]. r exp(t/drain) is a running
    maximum; its logarithm does not overflow.
    """
    applied = np.where(p > BITE, np.minimum(p, most), 0.0)
    grown = np.log(np.maximum(applied, 1e-30)) + (time - time[0]) / drain
    residual = np.exp(np.maximum.accumulate(grown) - (time - time[0]) / drain)
    return np.where(residual > np.maximum(p, 1e-20), residual, p)


LINE = (
    effect("hydraulic_delay", pressure=_delayed),
    effect("hydraulic_lag", pressure=_lagging),
    effect("hydraulic_oscillation", pressure=_oscillating),
    effect("rear_proportioning", pressure=_proportioned),
)
"""Effects between the master cylinder and the wheels, in the direction of flow."""

CALIPER = (
    effect("brake_threshold_pressure", pressure=_above_threshold),
    effect("caliper_hysteresis", pressure=_hysteresis),
    effect("residual_torque", pressure=_residual),
)
EFFECTS = (*LINE, *CALIPER)

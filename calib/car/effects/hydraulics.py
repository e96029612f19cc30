"""Effects of the brake lines, then of the calipers, each in the order in which they act.

A sensor of the wheel pressure sits between lines and calipers. The clamping pressure c is the
pressure that presses the pads.

Hysteresis comes from the friction of seals and pins: c follows a line of loading while the pressure
p rises and a line of release while p falls, and is constant in between, at any rate of p.

    c ^      release .---------.  loading     loading    c = p - r, not below zero
      |            .'        .'               release    c = p/(1 - u) + r
      |          .'        .'
      |        .'        .'                   u = (1 - s) w     share s of the loop's width w is
      |      .'        .'                     r = s w p_0/2     fixed, the rest grows with p
    r |    .'        .'
      +-----------.'--------> p
                  r

Because of r, the pads bite late, and c = r remains when the pedal is free. With the loading line L
and the release line U at each sample k: c[k] = max(L[k], min(U[k], c[k-1])).

Residual torque comes from pads that do not move back after the first release: they keep a residual
pressure q, which falls with the time constant of draining.

    c ^      .------.
      |    .'        '.
    q |  .'            '--...___
      +-'------------------------> t
"""

from collections.abc import Callable

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import QUARTILE
from calib.car.braking import BITE
from calib.car.effects.effect import Pair, Parameters, effect
from calib.car.history import RunHistory
from calib.car.lag import low_pass, second_order

_REFERENCE = 20e5
"""p_0 of a usual stop [Pa]. At equal c the width of the loop in p is 2 r + u (c - r), which is
w (s p_0 + (1 - s) (c - r)): w p_0 where c - r = p_0."""

_MAX_NOISE_BAND = 0.25e5
"""Largest assumed noise of a constant pressure [Pa]: three standard deviations of a noisy sensor
(0.4 bar at 200 Hz), averaged over 0.1 s."""


def _delayed(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressures after a ``delay`` [s], which is negative for a pressure that is logged late."""
    earlier = history.time - parameters["delay"]
    return np.interp(earlier, history.time, p_f), np.interp(earlier, history.time, p_r)


def _lagging(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressures after a lag without overshoot, from steady state at the first sample.

    ``lag_bend``, by default 0, is S/T^2 of `low_pass`, at most 1/4, since more would overshoot. Not
    valid for a line that fills faster than it empties.
    """
    T = parameters["time_constant"]
    if T <= 0.0:
        return p_f, p_r
    second = parameters.get("lag_bend", 0.0) * T**2
    return _of_both(lambda p: low_pass(history.time, p, T, second), p_f, p_r)


def _of_both(filtered: Callable[[Array], Array], p_f: Array, p_r: Array) -> Pair:
    """Filter the pressures of both axles, only once where they are the same array."""
    front = filtered(p_f)
    return front, front if p_r is p_f else filtered(p_r)


def _oscillating(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressures after a lag of second order that overshoots, with T = 1/w of the undamped mode.

    They are in steady state at the first sample. An overshoot does not take them below zero, or
    below a negative input (sensor noise). For a strongly damped line use `hydraulic_lag`.
    """
    T, damping = parameters["response_time"], parameters["line_damping"]
    if T <= 0.0:
        return p_f, p_r

    def overshooting(p: Array) -> Array:
        return np.maximum(second_order(history.time, p, 1.0 / T, damping), np.minimum(p, 0.0))

    return _of_both(overshooting, p_f, p_r)


def _proportioned(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressures behind a proportioning valve in the rear line, without hysteresis of the valve."""
    return p_f, behind_valve(p_r, parameters["knee"], parameters["knee_slope"])


def behind_valve(p: Array, knee: float, slope: float) -> Array:
    """Pressure [Pa] behind a proportioning valve, of ``slope`` [1] above the ``knee`` [Pa]."""
    return np.asarray(p - (1.0 - slope) * np.maximum(p - knee, 0.0))


def _above_threshold(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Pressures less the threshold of each axle; negative pressures (noise) keep their sign.

    ``threshold`` is that of the axle with the larger one. ``threshold_rear_share`` sets that of the
    other axle: 0.5, the default, gives both the same, 0 the front axle alone, 1 the rear axle
    alone. A negative threshold -t describes a sensor that reads t too little: p grows by t, but at
    most doubles, so that a released brake stays released.
    """
    larger, share = parameters["threshold"], parameters.get("threshold_rear_share", 0.5)
    front, rear = larger * min(1.0, 2.0 - 2.0 * share), larger * min(1.0, 2.0 * share)
    return _less_threshold(p_f, front), _less_threshold(p_r, rear)


def _less_threshold(p: Array, threshold: float) -> Array:
    if threshold < 0.0:
        return np.asarray(p + np.minimum(np.abs(p), -threshold))
    return np.asarray(p - np.clip(p, -threshold, threshold))


def _hysteresis(parameters: Parameters, history: RunHistory, p_f: Array, p_r: Array) -> Pair:
    """Clamping pressures with hysteresis, at first on the line of loading.

    Both axles have the same ``width`` w and ``fixed_share`` s, by default 0. A negative pressure
    (sensor noise) has no hysteresis. Not valid for a caliper whose seals pull the pads back.
    """
    width, share = parameters["width"], parameters.get("fixed_share", 0.0)
    u, r = (1.0 - share) * width, 0.5 * share * width * _REFERENCE
    return _of_both(lambda p: _denoised_loop(p, u, r), p_f, p_r)


def _denoised_loop(p: Array, u: float, r: float) -> Array:
    """`hysteresis_loop`, where changes of ``p`` within the band of its noise do not count.

    Otherwise noise would raise c step by step at a constant pressure. The result is exact without
    noise. With noise, a peak of the pressure counts as lower by one band, so a constant c after the
    peak comes out too low, by two bands at most.
    """
    # Third differences of white noise have sqrt(20) times its sigma, so the band is 13 sigma wide.
    # The band is not divided by sqrt(20), since smoothed noise has smaller third differences.
    sigma = np.median(np.abs(np.diff(p, 3))) / QUARTILE if p.size > 3 else 0.0
    band = min(3.0 * float(sigma), _MAX_NOISE_BAND)
    steady = _play(p - band, p + band, p[0])
    return np.asarray(p + (hysteresis_loop(steady, u, r) - steady))


def hysteresis_loop(p: Array, u: float, r: float) -> Array:
    """Clamping pressure c [Pa] (n,) at line pressure ``p`` (n,), with u [1] and r [Pa] as above."""
    loading = p - np.clip(p, 0.0, r)
    return _play(loading, p / (1.0 - u) + r, loading[0])


def _play(lowest: Array, highest: Array, first: float) -> Array:
    """c[k] = max(lowest[k], min(highest[k], c[k-1])) (n,), with c[0] = ``first``.

    Clipping to a range and then to a second one is clipping to a third range. So log2(n) passes
    join the ranges of 2, 4, 8 ... successive samples.
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
    """Clamping pressures with the residual pressure that a braking above `BITE` leaves.

    ``rear_bias`` is 0 if both axles keep the residual pressure, 1 if only the rear axle does, -1 if
    only the front axle does. Not valid for pads that are knocked back by the disc.
    """
    limit, bias = parameters["residual_pressure"], parameters["rear_bias"]
    if limit <= 0.0:
        return p_f, p_r
    drain = parameters["drain_time"]
    front = residual_clamp(history.time, p_f, limit * min(1.0, 1.0 - bias), drain)
    return front, residual_clamp(history.time, p_r, limit * min(1.0, 1.0 + bias), drain)


def residual_clamp(time: Array, p: Array, limit: float, drain: float) -> Array:
    """Clamping pressure max(p, q) [Pa] (n,) with the residual pressure q.

    q decays as exp(-t/``drain``), and is lifted to min(p, ``limit``) while the brake is applied. So
    q exp(t/drain) is a running maximum; its logarithm does not overflow. ``time`` [s] and ``p``
    [Pa] are (n,); ``limit`` [Pa], ``drain`` [s].
    """
    applied = np.where(p > BITE, np.minimum(p, limit), 0.0)
    log_grown = np.log(np.maximum(applied, 1e-30)) + (time - time[0]) / drain  # no logarithm of 0
    residual = np.exp(np.maximum.accumulate(log_grown) - (time - time[0]) / drain)
    return np.where(residual > np.maximum(p, 1e-20), residual, p)  # 1e-20 Pa is no pressure


LINE = (
    effect("hydraulic_delay", pressure=_delayed),
    effect("hydraulic_lag", pressure=_lagging),
    effect("hydraulic_oscillation", pressure=_oscillating),
    effect("rear_proportioning", pressure=_proportioned),
)
"""Effects between the master cylinder and the sensors of the wheel pressures."""

CALIPER = (
    effect("brake_threshold_pressure", pressure=_above_threshold),
    effect("caliper_hysteresis", pressure=_hysteresis),
    effect("residual_torque", pressure=_residual),
)
"""Effects behind these sensors."""

EFFECTS = (*LINE, *CALIPER)

"""Linear lags of first and second order, and delays, at the samples of any clock.

The input is taken as linear between its samples. For such an input the result is exact, whether the
samples are evenly spaced or not. A lag is in steady state at the first sample.
"""

from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array

_LEAST_DIFFERENCE = 1e-3  # of two time constants over their sum [1], since it is a divisor


def integral(time: Array, x: Array) -> Array:
    """Return the integral of ``x`` (n,) over ``time`` [s] (n,) from the first sample on."""
    return np.concatenate([[0.0], np.cumsum(0.5 * (x[1:] + x[:-1]) * np.diff(time))])


def delayed(time: Array, x: Array, delay: float) -> Array:
    """Return the values that ``x`` (n,) had a ``delay`` [s] before ``time`` [s] (n,).

    ``delay`` is not negative. ``x`` is linear between samples, and before the first sample it is on
    the line through the first two samples.
    """
    if delay == 0.0:
        return x
    earlier = time - delay
    slope = (x[1] - x[0]) / (time[1] - time[0])
    before_start = np.minimum(earlier - time[0], 0.0)  # [s], not positive
    return np.asarray(np.interp(earlier, time, x) + slope * before_start)


def first_order(time: Array, x: Array, time_constant: float) -> Array:
    """Return y of T dy/dt + y = x at ``time`` [s] (n,), ``x`` (n,), T [s] above zero."""
    return np.asarray(_follow(time, x, -1.0 / time_constant), float)


def second_order(time: Array, x: Array, frequency: float, damping: float) -> Array:
    """Return y of y'' + 2 D w y' + w^2 y = w^2 x at ``time`` [s] (n,); ``x`` (n,).

    ``frequency`` w [rad/s]; ``damping`` D [1], 0 <= D < 1: valid for an oscillating mode only.
    """
    pole = frequency * complex(-damping, np.sqrt(1.0 - damping**2))
    # partial fractions: y = c f + (c f)* with f' = p (f - x) and c = -p*/(2 i Im p), p the pole
    follower = _follow(time, x, pole)
    return np.asarray(np.imag(pole * np.conj(follower)) / pole.imag, float)


def low_pass(time: Array, x: Array, time_constant: float, second: float) -> Array:
    """Return y of S y'' + T y' + y = x at ``time`` [s] (n,); ``x`` (n,).

    ``time_constant`` T [s] > 0 is the delay by which y follows a slowly changing x. ``second`` S
    [s^2] is not negative: 0 is a lag of first order, T^2/4 two equal lags in a row, T^2/2 a
    Butterworth filter.
    """
    q = second / time_constant**2
    root = np.sqrt(abs(1.0 - 4.0 * q))
    if q > 0.25 and root > _LEAST_DIFFERENCE:
        frequency = 1.0 / (np.sqrt(q) * time_constant)
        return second_order(time, x, frequency, 0.5 / np.sqrt(q))
    # two lags in a row, whose time constants T (1 +- root)/2 have the sum T and the product S
    root = max(root, _LEAST_DIFFERENCE)
    slow, fast = 0.5 * time_constant * (1.0 + root), 0.5 * time_constant * (1.0 - root)
    if fast <= 0.0:
        return first_order(time, x, time_constant)
    weighted = slow * first_order(time, x, slow) - fast * first_order(time, x, fast)
    return np.asarray(weighted / (slow - fast))


def _follow(time: Array, x: Array, pole: complex) -> NDArray[Any]:
    """Return y of y' = pole (y - x), from steady state."""
    from scipy.linalg.lapack import dtbtrs, ztbtrs

    # The error e = y - x has e' = pole e - x'. With a = pole dt and x linear between samples,
    # e[k+1] = exp(a) e[k] - (x[k+1] - x[k]) (exp(a) - 1)/a: a bidiagonal system of equations.
    a = pole * np.diff(time)
    growth = np.expm1(a)
    bands = np.ones((2, x.size), a.dtype)  # the diagonal, and the band below it
    bands[1, :-1] = -1.0 - growth
    right_side = np.concatenate([[0.0], -np.diff(x) * growth / a])
    solve = ztbtrs if np.iscomplexobj(a) else dtbtrs
    error, _ = solve(bands, right_side[:, None], uplo="L")
    return np.asarray(x + error[:, 0])

"""Noise: its size, and the moving average of differences."""

import math

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import QUARTILE


def second_differences(white: float, walk: float, turned: float) -> tuple[Array, float]:
    """The moving average (3,) and sigma of second differences of v against the integral of a_x.

    ``white`` variance of v, ``walk`` of a step of the integral, ``turned`` of a change of its step,
    as by a slope that wanders [m^2/s^2].
    """
    covariance = [6.0 * white + 2.0 * walk + turned, -4.0 * white - walk, white]
    return moving_average(np.array(covariance))


def moving_average(covariance: Array) -> tuple[Array, float]:
    """Coefficients (q + 1,), the first is 1, and sigma of a moving average that can be undone.

    From its ``covariance`` (q + 1,) at the distances 0 to q. Its spectrum is a polynomial whose
    roots come in pairs z, 1/z: those within the unit circle are taken (Brockwell and Davis, Time
    Series: Theory and Methods, section 3.1).
    """
    roots = np.roots(np.concatenate([covariance[:0:-1], covariance]))
    inside = sorted(roots, key=abs)[: covariance.size - 1]
    average = np.real(np.poly(inside))
    return average, float(np.sqrt(covariance[-1] / average[-1]))


def white_noise(x: Array, order: int = 3) -> float:
    """Standard deviation of white noise on a smooth x (n,), by its differences of an ``order``.

    Their median, which the bite of a brake does not move. Third differences hold almost no motion.

    >>> round(white_noise(np.random.default_rng(0).normal(size=10000)), 1)
    1.0
    """
    size = float(np.median(np.abs(np.diff(x, order)))) / QUARTILE
    return size / math.sqrt(math.comb(2 * order, order))

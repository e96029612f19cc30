"""The mean of several things that were measured alike, and what one more of them may be.

    x_i = mean + b_i + e_i        b_i ~ N(0, between)        e_i ~ N(0, v), v known

The scatter s^2 of the x_i is that of both, so s/sqrt(k) is the error of their mean, and one more
thing that is measured like these lies s sqrt(1 + 1/k) about it, with Student's t of k - 1 degrees
of freedom: exact for normal x_i. Things may agree by chance, so no interval is narrower than the
normal one of v alone.

Not true where the e_i are correlated: add shared errors to the error of the mean, not to v.
"""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import Z95


@dataclass(frozen=True)
class RandomEffects:
    """Mean of k things, for each of n quantities. Shapes (n,), in the quantities' units.

    ``sigma`` standard error of the mean, and ``one_more`` standard deviation of one more thing
    about it, both to be used with Student's t of ``freedom`` = k - 1; ``between`` standard
    deviation between the things, without that of their own errors.
    """

    mean: Array
    sigma: Array
    one_more: Array
    between: Array
    freedom: int


def random_effects(values: Array, variances: Array) -> RandomEffects:
    """Mean of ``values`` (k, n) with known ``variances`` (k, n) of their own, k of 2 or more.

    >>> found = random_effects(np.array([[1.0], [3.0]]), np.array([[0.5], [0.5]]))
    >>> found.mean.tolist(), (found.between**2).round(9).tolist(), found.freedom
    ([2.0], [1.5], 1)
    """
    x, own = np.asarray(values, float), np.mean(variances, axis=0)
    k, scatter = x.shape[0], np.var(x, axis=0, ddof=1)
    between = np.sqrt(np.maximum(scatter - own, 0.0))
    scatter = np.maximum(scatter, own * (Z95 / quantile95(k - 1)) ** 2)
    sigma, one_more = np.sqrt(scatter / k), np.sqrt(scatter * (1.0 + 1.0 / k))
    return RandomEffects(x.mean(axis=0), sigma, one_more, between, k - 1)


def quantile95(freedom: int) -> float:
    """0.975 quantile of Student's t."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.975))


def as_sigma(t: float, freedom: int) -> float:
    """The quantile of the normal distribution as rare as ``t`` of Student's t."""
    from scipy.special import ndtri, stdtr

    tail = max(float(stdtr(freedom, -abs(t))), 1e-300)  # 37 sigma
    return float(np.copysign(-ndtri(tail), t))

"""The mean of k things that were measured alike, and the prediction for one thing more.

    x_i = mean + b_i + e_i        b_i ~ N(0, between)        e_i ~ N(0, v), v known

The scatter s^2 of the x_i holds both variances, so s/sqrt(k) is the standard error of their mean.
The value of one thing more, measured like these, lies s sqrt(1 + 1/k) about the mean. For normal
x_i, Student's t of k - 1 degrees of freedom gives exact intervals. A few x_i may agree by chance,
so no interval is narrower than the normal interval of v alone.

Not true where the e_i are correlated: add shared errors to the error of the mean, not to v.
"""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import Z95


@dataclass(frozen=True)
class RandomEffects:
    """Mean of k things, for each of n quantities; shapes (n,), in the units of the quantities.

    For intervals, use both sigmas with Student's t of ``freedom``.
    """

    mean: Array
    sigma: Array  # standard error of the mean
    prediction_sigma: Array  # standard deviation of one thing more about the mean
    between: Array  # standard deviation of the b_i
    freedom: int  # k - 1


def random_effects(values: Array, variances: Array) -> RandomEffects:
    """Mean of the ``values`` (k, n) with the known ``variances`` (k, n) of their errors, k >= 2.

    >>> effects = random_effects(np.array([[1.0], [3.0]]), np.array([[0.5], [0.5]]))
    >>> effects.mean.tolist(), (effects.between**2).round(9).tolist(), effects.freedom
    ([2.0], [1.5], 1)
    """
    x, error_variance = np.asarray(values, float), np.mean(variances, axis=0)
    k, scatter = x.shape[0], np.var(x, axis=0, ddof=1)  # s^2
    between = np.sqrt(np.maximum(scatter - error_variance, 0.0))
    # no interval with Student's t is narrower than the normal interval of the errors alone
    scatter = np.maximum(scatter, error_variance * (Z95 / quantile95(k - 1)) ** 2)
    sigma, prediction_sigma = np.sqrt(scatter / k), np.sqrt(scatter * (1.0 + 1.0 / k))
    return RandomEffects(x.mean(axis=0), sigma, prediction_sigma, between, k - 1)


def quantile95(freedom: int) -> float:
    """0.975 quantile of Student's t, the half width of a 95 % interval over sigma."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.975))


def normal_equivalent(t: float, freedom: int) -> float:
    """The standard normal number that is as improbable as ``t`` of Student's t."""
    from scipy.special import ndtri, stdtr

    tail = max(float(stdtr(freedom, -abs(t))), 1e-300)  # at most 37 standard deviations
    return float(np.copysign(-ndtri(tail), t))

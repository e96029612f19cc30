"""The normal distribution: numbers of its intervals, the size of noise, and mixtures."""

import math
from itertools import takewhile
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array

Z95 = 1.96
"""Half width of a 95 % interval over sigma, the 0.975 quantile (1.959964) to the two decimals of
every textbook. Bands of stored tables are made with it: more digits would move each of them."""

QUARTILE = 0.6745
"""Upper quartile over sigma: the median of |x| of noise is this many sigma. Four digits, as the
outputs were made with."""

NINETY = 1.645
"""Size of noise over sigma that a tenth of it exceeds."""


SURE, CERTAIN = 3.0, 8.0
"""ln of the odds from which a mistake is named, and from which it is certain: 20 and 3,000 to 1.

A car near ideal balance, with tyres of an unusual form and no motor, had 6.4 for a motor."""


def second_differences(white: float, walk: float, turned: float) -> tuple[Array, float]:
    """The moving average (3,) and sigma of second differences of v against the integral of a_x.

    ``white`` variance of v, ``walk`` of a step of the integral, ``turned`` of a change of its step,
    as by a slope that wanders [m^2/s^2]. The spectrum of their covariance is a polynomial whose
    roots come in pairs z, 1/z: with those within the unit circle the average can be undone
    (Brockwell and Davis, Time Series: Theory and Methods, section 3.1).
    """
    covariance = [6.0 * white + 2.0 * walk + turned, -4.0 * white - walk, white]
    roots = np.roots([*covariance[:0:-1], *covariance])
    average = np.real(np.poly(sorted(roots, key=abs)[:2]))
    return average, float(np.sqrt(white / average[-1]))


def scatter(x: Array) -> float:
    """Standard deviation from zero of most of the values (n,), which outliers do not move.

    >>> round(scatter(np.array([-1.0, 1.0, 1.0, 1.0, 99.0])), 3)
    1.483
    """
    return float(np.median(np.abs(x))) / QUARTILE


def white_noise(x: Array, order: int = 3, lag: int = 1) -> float:
    """Standard deviation of white noise on a smooth x (n,), by its differences of an ``order``.

    Over ``lag`` samples each. Their median, which the bite of a brake does not move. Third
    differences hold almost no motion.

    >>> round(white_noise(np.random.default_rng(0).normal(size=10000)), 1)
    1.0
    """
    for _ in range(order):
        x = x[lag:] - x[:-lag]
    return scatter(x) / math.sqrt(math.comb(2 * order, order))


def noise_over(x: Array, longest: float) -> list[float]:
    """`white_noise` of x (n,) over 1, 2, 4 ... up to ``longest`` samples, and to a third of x."""
    lags = (1 << i for i in range(64))
    within = takewhile(lambda lag: lag <= longest and 3 * lag < x.size, lags)
    return [white_noise(x, lag=lag) for lag in within]


class Mixture(NamedTuple):
    """Mean (..., n) and covariance (..., n, n) of the mixture.

    ``weights`` (..., k) of the explanations, ``means`` (..., k, n) under each; ``evidence`` (...)
    logarithm of the measurement's likelihood under all of them, up to the same constant.
    """

    mean: Array
    covariance: Array
    weights: Array
    means: Array
    evidence: Array


class Posterior(NamedTuple):
    """Means (..., n) and covariances (..., n, n) of the unknowns of linear Gaussian models.

    ``evidence`` (...) logarithm of the likelihood over that where all unknowns are zero.
    """

    means: Array
    covariances: Array
    evidence: Array


def posterior(information: Array, side: Array, sigma: Array) -> Posterior:
    """Posterior of unknowns that are independent, around zero with ``sigma`` (..., n) beforehand.

    ``information`` (..., n, n) and ``side`` (..., n) of the measurement alone: the unknowns that
    fit it best solve information x = side. In units of sigma, so that the wide ones cost no digits.
    """
    scale = sigma[..., :, None] * sigma[..., None, :]
    total = np.eye(sigma.shape[-1]) + scale * information
    covariances = scale * np.linalg.inv(total)
    side = np.broadcast_to(side, covariances.shape[:-1])
    means = np.einsum("...ij,...j->...i", covariances, side)
    evidence = 0.5 * (np.sum(side * means, axis=-1) - np.linalg.slogdet(total)[1])
    return Posterior(means, covariances, evidence)


def weigh_hypotheses(
    information: Array, side: Array, sigma: Array, odds: Array, likelihood: Array
) -> Mixture:
    """Weigh explanations that differ in how far each unknown may be from zero, or in their noise.

    ``information`` (..., k, n, n), ``side`` (..., k, n) and ``sigma`` (k, n) as in `posterior`,
    under each explanation; ``odds`` (k,) of the explanations beforehand, up to a factor.
    ``likelihood`` (..., k) the logarithm of the measurement's likelihood where all unknowns are
    zero, up to a common constant. The weights follow from the marginal likelihoods; mean and
    covariance are those of the mixture.
    """
    means, covariances, evidence = posterior(information, side, sigma)
    evidence = evidence + likelihood + np.log(odds)
    most = evidence.max(axis=-1, keepdims=True)
    weights = np.exp(evidence - most)
    total_weight = weights.sum(axis=-1, keepdims=True)
    weights /= total_weight
    mean = np.einsum("...k,...ki->...i", weights, means)
    apart = means - mean[..., None, :]
    spread = covariances + apart[..., :, None] * apart[..., None, :]
    mixed = np.einsum("...k,...kij->...ij", weights, spread)
    return Mixture(mean, mixed, weights, means, (most + np.log(total_weight))[..., 0])


_MOST = 300.0
"""Largest logarithm of a ratio: more is sure."""


def likelihood_ratio(x: float, sigma: float, spread: float) -> float:
    """How much likelier x is where a quantity is there than where it is not; at most e^300.

    There it is half of a normal distribution of ``spread`` M, not below zero; elsewhere zero; seen
    as x with the same ``sigma`` u: 2 u/h exp(x^2/2 (1/u^2 - 1/h^2)) Phi(x M/(u h)), h = hypot(u, M)
    and Phi the normal distribution.
    """
    h = math.hypot(sigma, spread)
    normal = 0.5 * math.erfc(-x * spread / (sigma * h * math.sqrt(2.0)))
    if normal == 0.0:
        return 0.0
    apart = 1.0 / sigma**2 - 1.0 / h**2
    return math.exp(min(math.log(2.0 * sigma / h * normal) + 0.5 * x**2 * apart, _MOST))

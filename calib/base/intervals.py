"""The normal distribution: quantiles, noise, posteriors, and mixtures."""

import cmath
import math
from itertools import takewhile
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array

Z95 = 1.96  # half width of a 95 % interval over sigma; more digits would change stored bands
QUARTILE = 0.6745  # median of |x| over sigma, the upper quartile; outputs rest on four digits
NINETY = 1.645  # 90 % quantile of |x| over sigma

SURE, CERTAIN = 3.0, 8.0
"""ln of the odds from which a mistake is reported, and from which it is certain: 20 and 3,000 to 1.

A car near ideal balance, with tyres of an unusual form and no motor, had 6.4 for a motor."""


def second_differences(white: float, walk: float, turned: float) -> tuple[Array, float]:
    """The moving average (3,) and sigma of second differences of v against the integral of a_x.

    ``white`` variance of v, ``walk`` of a step of the integral, ``turned`` of a change of its step,
    as by a slope that walks [m^2/s^2]. The roots of their spectrum come in pairs z, 1/z; those in
    the unit circle make the average invertible (Brockwell and Davis, Time Series: Theory and
    Methods, section 3.1).
    """
    # of the spectrum over z^2, white y^2 - (4 white + walk) y + 4 white + 2 walk + turned is left,
    # with y = z + 1/z
    apart = cmath.sqrt(walk**2 - 4.0 * white * turned)
    sums = [(4.0 * white + walk + sign * apart) / (2.0 * white) for sign in (1.0, -1.0)]
    inner, other = (2.0 / (y + cmath.sqrt(y + 2.0) * cmath.sqrt(y - 2.0)) for y in sums)
    average = np.array([1.0, -(inner + other).real, (inner * other).real])
    return average, math.sqrt(white / average[-1])


def scatter(x: Array) -> float:
    """Robust standard deviation of values (n,) about zero."""
    return float(np.median(np.abs(x))) / QUARTILE


def white_noise(x: Array, order: int = 3, lag: int = 1) -> float:
    """Standard deviation of white noise on a smooth x (n,), by differences over ``lag`` samples.

    Third differences contain almost no motion, and their median no bite of a brake.
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
    """Mean (..., n) and covariance (..., n, n) of a mixture of k hypotheses.

    ``weights`` (..., k), ``means`` (..., k, n) under each; ``evidence`` (...) logarithm of the
    likelihood under all of them, up to a constant.
    """

    mean: Array
    covariance: Array
    weights: Array
    means: Array
    evidence: Array


class Posterior(NamedTuple):
    """Posterior of linear Gaussian models, shapes (..., n) and (..., n, n).

    ``evidence`` (...): logarithm of the likelihood over that where all unknowns are zero.
    """

    means: Array
    covariances: Array
    evidence: Array


def posterior(information: Array, side: Array, sigma: Array) -> Posterior:
    """Posterior of unknowns with independent priors about zero of ``sigma`` (..., n).

    ``information`` (..., n, n) and ``side`` (..., n) are the normal equations of the measurement,
    information x = side. Solved in units of sigma, so that wide priors cost no digits.
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
    """Weigh k hypotheses by their marginal likelihoods.

    ``information`` (..., k, n, n), ``side`` (..., k, n) and ``sigma`` (k, n) as in `posterior`;
    prior ``odds`` (k,), up to a factor; ``likelihood`` (..., k) its logarithm where all unknowns
    are zero, up to a common constant.
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


_MOST = 300.0  # largest logarithm of a ratio


def likelihood_ratio(x: float, sigma: float, spread: float) -> float:
    """Likelihood ratio of a quantity that is present to one that is zero, at most e^300.

    Present, it has a half-normal prior of ``spread`` M above zero. Measured as x with ``sigma`` u:
    2 u/h exp(x^2/2 (1/u^2 - 1/h^2)) Phi(x M/(u h)), h = hypot(u, M), Phi the normal distribution.
    """
    h = math.hypot(sigma, spread)
    normal = 0.5 * math.erfc(-x * spread / (sigma * h * math.sqrt(2.0)))
    if normal == 0.0:
        return 0.0
    apart = 1.0 / sigma**2 - 1.0 / h**2
    return math.exp(min(math.log(2.0 * sigma / h * normal) + 0.5 * x**2 * apart, _MOST))

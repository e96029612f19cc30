"""Statistics of normal errors: quantiles, noise of signals, posteriors, likelihood ratios."""

import cmath
import math
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array

Z95 = 1.96  # half width of a 95 % interval over sigma; more digits would change stored bands
QUARTILE = 0.6745  # median of |x| over sigma; four digits, since outputs rest on them
Z90 = 1.645  # 90 % quantile of |x| over sigma

LIKELY_LOG_ODDS = 3.0
"""ln of the odds from which a mistake is reported: 20 to 1."""
CERTAIN_LOG_ODDS = 8.0
"""ln of the odds from which a mistake counts as certain: 3,000 to 1.

A sound log can reach 6.4: near ideal balance, tyres of unusual form look like a motor.
"""


def scatter(x: Array) -> float:
    """Robust standard deviation of values (n,) about zero."""
    return float(np.median(np.abs(x))) / QUARTILE


def white_noise(x: Array, order: int = 3, lag: int = 1) -> float:
    """Standard deviation of the white noise on a smooth signal ``x`` (n,).

    It follows from ``order``-th differences of values ``lag`` samples apart. Third differences
    contain almost no motion of the car, and their median ignores the bite of a brake.
    """
    for _ in range(order):
        x = x[lag:] - x[:-lag]
    return scatter(x) / math.sqrt(math.comb(2 * order, order))  # variance of differences of noise


def noise_over(x: Array, longest: float) -> list[float]:
    """`white_noise` of ``x`` (n,) at lags of 1, 2, 4 ... up to ``longest`` samples, below n/3."""
    lags = [2**i for i in range(x.size.bit_length())]
    return [white_noise(x, lag=lag) for lag in lags if lag <= longest and 3 * lag < x.size]


def second_difference_model(white: float, walk: float, step_walk: float) -> tuple[Array, float]:
    """Model the second differences of e = v - integral of a_x as a moving average.

    e is the sum of white noise, a random walk, and a walk whose step is itself a random walk, as on
    a changing slope. The parameters are the variances of the white noise, of the steps of the
    random walk, and of the changes of the step [m^2/s^2]. Returns the coefficients (3,) and the
    standard deviation of the white noise [m/s] that is averaged. With the shift q by one sample
    and y = q + 1/q, the spectrum of the second differences is

        white (2 - y)^2 + walk (2 - y) + step_walk

    Its zeros are pairs q and 1/q. Those within the unit circle give the moving average that can be
    inverted (Brockwell and Davis, Time Series: Theory and Methods, section 3.1).
    """
    root = cmath.sqrt(walk**2 - 4.0 * white * step_walk)
    zeros_y = [(4.0 * white + walk + sign * root) / (2.0 * white) for sign in (1.0, -1.0)]
    # q + 1/q = y has the zero q = 2/(y + sqrt(y^2 - 4)) within the unit circle
    first, second = (2.0 / (y + cmath.sqrt(y + 2.0) * cmath.sqrt(y - 2.0)) for y in zeros_y)
    average = np.array([1.0, -(first + second).real, (first * second).real])
    # the coefficient of q^2 is ``white`` in the spectrum, variance * average[2] in the average's
    return average, math.sqrt(white / average[2])


def posterior(information: Array, side: Array, sigma: Array) -> tuple[Array, Array, Array]:
    """Return means (..., n) and covariances (..., n, n) of n unknowns x, and the evidence (...).

    ``information`` (..., n, n) and ``side`` (..., n) are the normal equations of the measurement,
    information x = side. The priors are independent and normal about zero, of ``sigma`` (..., n).
    The evidence is ln of the marginal likelihood over the likelihood of x = 0.
    """
    # solved in units of sigma, so that wide priors cost no digits
    scale = sigma[..., :, None] * sigma[..., None, :]  # (..., n, n)
    total = np.eye(sigma.shape[-1]) + scale * information  # prior and measurement
    covariances = scale * np.linalg.inv(total)
    side = np.broadcast_to(side, covariances.shape[:-1])
    means = np.einsum("...ij,...j->...i", covariances, side)
    evidence = 0.5 * (np.sum(side * means, axis=-1) - np.linalg.slogdet(total)[1])
    return means, covariances, evidence


class Mixture(NamedTuple):
    """Posterior of n unknowns, a mixture over k hypotheses."""

    mean: Array  # of the mixture, (..., n)
    covariance: Array  # of the mixture, (..., n, n)
    weights: Array  # posterior probabilities of the hypotheses, (..., k)
    means: Array  # under each hypothesis, (..., k, n)
    evidence: Array  # ln of the marginal likelihood, up to a constant, (...)


def weigh_hypotheses(
    information: Array, side: Array, sigma: Array, odds: Array, likelihood: Array
) -> Mixture:
    """Weigh k hypotheses by their marginal likelihoods.

    ``information`` (..., k, n, n), ``side`` (..., k, n) and ``sigma`` (k, n) are as in `posterior`.
    ``odds`` (k,) are the prior odds, up to a common factor. ``likelihood`` (..., k) is ln of the
    likelihood of x = 0, up to a common constant.
    """
    means, covariances, evidence = posterior(information, side, sigma)
    evidence = evidence + likelihood + np.log(odds)  # (..., k)
    largest = evidence.max(axis=-1, keepdims=True)
    weights = np.exp(evidence - largest)  # without overflow
    total_weight = weights.sum(axis=-1, keepdims=True)
    weights /= total_weight
    mean = np.einsum("...k,...ki->...i", weights, means)
    offsets = means - mean[..., None, :]  # (..., k, n)
    second_moments = covariances + offsets[..., :, None] * offsets[..., None, :]
    covariance = np.einsum("...k,...kij->...ij", weights, second_moments)
    total_evidence = (largest + np.log(total_weight))[..., 0]
    return Mixture(mean, covariance, weights, means, total_evidence)


_MAX_LOG_RATIO = 300.0  # largest ln of a likelihood ratio, so that exp does not overflow


def likelihood_ratio(x: float, sigma: float, spread: float) -> float:
    """Likelihood ratio of a quantity that is present to one that is zero, at most e^300.

    The quantity is measured as ``x`` with the standard deviation ``sigma``. If present, it is
    positive, with a half-normal prior of scale ``spread``. With u = ``sigma``, m = ``spread``,
    h^2 = u^2 + m^2 and the normal distribution Phi, the ratio is

        2 u/h exp(x^2/2 (1/u^2 - 1/h^2)) Phi(x m/(u h))

    Beyond 38 sigma below zero, where Phi underflows, it is 0.
    """
    h = math.hypot(sigma, spread)
    normal = 0.5 * math.erfc(-x * spread / (sigma * h * math.sqrt(2.0)))  # Phi
    if normal == 0.0:
        return 0.0
    exponent = 0.5 * x**2 * (1.0 / sigma**2 - 1.0 / h**2)
    return math.exp(min(math.log(2.0 * sigma / h * normal) + exponent, _MAX_LOG_RATIO))

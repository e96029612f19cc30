"""Several explanations of one measurement, weighed by how well each predicted it."""

import math
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array


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


def weigh_hypotheses(
    information: Array,
    side: Array,
    sigma: Array,
    odds: Array,
    likelihood: Array | float = 0.0,
) -> Mixture:
    """Weigh explanations that differ in how far each unknown may be from zero, or in their noise.

    ``information`` (..., k, n, n) and ``side`` (..., k, n) of the measurement alone: the unknowns
    that fit it best solve information x = side; k may be 1 where the explanations have one noise.
    ``sigma`` (k, n) of the unknowns under each explanation, independent and around zero; ``odds``
    (k,) of the explanations beforehand, up to a factor. ``likelihood`` (..., k) the logarithm of
    the measurement's likelihood where all unknowns are zero, up to a common constant. The weights
    follow from the marginal likelihoods; mean and covariance are those of the mixture.
    """
    prior = sigma**-2.0
    total = information + prior[:, :, None] * np.eye(prior.shape[1])
    covariance = np.linalg.inv(total)
    means = np.einsum("...kij,...kj->...ki", covariance, np.broadcast_to(side, total.shape[:-1]))
    evidence = 0.5 * np.sum(side * means, axis=-1) + likelihood
    evidence += 0.5 * (np.log(prior).sum(axis=1) - np.linalg.slogdet(total)[1]) + np.log(odds)
    most = evidence.max(axis=-1, keepdims=True)
    weights = np.exp(evidence - most)
    total_weight = weights.sum(axis=-1, keepdims=True)
    weights /= total_weight
    mean = np.einsum("...k,...ki->...i", weights, means)
    apart = means - mean[..., None, :]
    spread = covariance + apart[..., :, None] * apart[..., None, :]
    mixed = np.einsum("...k,...kij->...ij", weights, spread)
    return Mixture(mean, mixed, weights, means, (most + np.log(total_weight))[..., 0])


class _MixturePosterior(NamedTuple):
    """Mean and standard deviation of the mixture, and the weight of the nominal hypothesis."""

    mean: Array
    sigma: Array
    nominal_weight: Array


def mixture_posterior(
    deviation: Array | float,
    sigma: Array | float,
    free_sigma: float,
    odds: Array | float,
    nominal_sigma: float,
) -> _MixturePosterior:
    """Weigh whether a number is nominal or free, by its measured ``deviation`` and its ``sigma``.

    ``free_sigma`` is the spread under the free hypothesis, which must already be part of the
    measurement's posterior; ``odds`` are those of nominal before the measurement; ``nominal_sigma``
    how exactly nominal holds. All of one unit. A deviation that cannot be told from nominal does
    not pay for the noise; one far outside ``free_sigma`` is given back as measured.
    """
    d, s = np.asarray(deviation, float), np.asarray(sigma, float)
    at_nominal = np.hypot(s, nominal_sigma)
    # log of the Savage-Dickey ratio: posterior over prior density around nominal
    log_ratio = np.log(odds * free_sigma / at_nominal) - 0.5 * (d / at_nominal) ** 2
    weight = 1.0 / (1.0 + np.exp(-np.clip(log_ratio, -700.0, 700.0)))
    kept = (nominal_sigma / at_nominal) ** 2
    mean_nominal, variance_nominal = kept * d, kept * s**2
    mean = weight * mean_nominal + (1.0 - weight) * d
    between = weight * (1.0 - weight) * (d - mean_nominal) ** 2
    variance = weight * variance_nominal + (1.0 - weight) * s**2 + between
    return _MixturePosterior(mean, np.sqrt(variance), weight)


# A quantity that is not below zero where it is there: half of a normal distribution of ``spread`` M
# there, zero where not; seen as x with the same ``sigma`` u. h = hypot(u, M).

_MOST = 300.0
"""Largest logarithm of a ratio: more is sure."""

_FAR = -5.0
"""Standard deviations below zero from which the quantity is as good as none."""


def likelihood_ratio(x: float, sigma: float, spread: float) -> float:
    """How much likelier x is where the quantity is there than where it is not; at most e^300."""
    return math.exp(min(log_likelihood_ratio(x, sigma, spread), _MOST))


def log_likelihood_ratio(x: float, sigma: float, spread: float) -> float:
    """The logarithm of 2 u/h exp(x^2/2 (1/u^2 - 1/h^2)) Phi(x M/(u h)).

    With the normal distribution Phi; -inf where x is so far below zero that Phi is zero.
    """
    h = math.hypot(sigma, spread)
    normal = 0.5 * math.erfc(-x * spread / (sigma * h * math.sqrt(2.0)))
    if normal == 0.0:
        return -math.inf
    apart = 1.0 / sigma**2 - 1.0 / h**2
    return math.log(2.0 * sigma / h * normal) + 0.5 * x**2 * apart


def mean_square(x: float, sigma: float, spread: float) -> float:
    """Mean of the square of the quantity, if it is there and was seen as x.

    With m = x M^2/h^2 and s = u M/h, those of the normal distribution that it has above zero, and
    t = m/s: s^2 + m^2 + m s phi(t)/Phi(t) (Johnson, Kotz and Balakrishnan, Continuous Univariate
    Distributions, vol. 1, section 10.1).
    """
    h = math.hypot(sigma, spread)
    s = sigma * spread / h
    t = max(x / sigma * spread / h, _FAR)
    m = s * t
    ratio = math.exp(-0.5 * t**2) / math.sqrt(0.5 * math.pi) / math.erfc(-t / math.sqrt(2.0))
    return s**2 + m**2 + m * s * ratio

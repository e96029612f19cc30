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


# A quantity that is not below zero where it is there: half of a normal distribution of ``spread`` M
# there, zero where not; seen as x with the same ``sigma`` u. h = hypot(u, M).

_MOST = 300.0
"""Largest logarithm of a ratio: more is sure."""


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

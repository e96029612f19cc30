"""Several explanations of one measurement, weighed by how well each predicted it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


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

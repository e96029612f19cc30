"""Several explanations of one measurement, weighed by how well each predicted it."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class Mixture(NamedTuple):
    """Mean (..., n) and covariance (..., n, n) of the mixture.

    ``weights`` (..., k) of the explanations and ``means`` (..., k, n) under each.
    """

    mean: Array
    covariance: Array
    weights: Array
    means: Array


def weigh_hypotheses(information: Array, side: Array, sigma: Array, odds: Array) -> Mixture:
    """Weigh explanations that differ in how far each unknown may be from zero.

    ``information`` (..., n, n) and ``side`` (..., n) of the measurement alone: the unknowns that
    fit it best solve information x = side. ``sigma`` (k, n) of the unknowns under each explanation,
    independent and around zero; ``odds`` (k,) of the explanations beforehand, up to a factor. The
    weights follow from the marginal likelihoods; mean and covariance are those of the mixture.
    """
    prior = sigma**-2.0
    total = information[..., None, :, :] + prior[:, :, None] * np.eye(prior.shape[1])
    covariance = np.linalg.inv(total)
    means = np.einsum("...kij,...j->...ki", covariance, side)
    evidence = 0.5 * np.einsum("...i,...ki->...k", side, means)
    evidence += 0.5 * (np.log(prior).sum(axis=1) - np.linalg.slogdet(total)[1]) + np.log(odds)
    weights = np.exp(evidence - evidence.max(axis=-1, keepdims=True))
    weights /= weights.sum(axis=-1, keepdims=True)
    mean = np.einsum("...k,...ki->...i", weights, means)
    apart = means - mean[..., None, :]
    spread = covariance + apart[..., :, None] * apart[..., None, :]
    return Mixture(mean, np.einsum("...k,...kij->...ij", weights, spread), weights, means)

"""Two hypotheses about one number: it is what it should be, or it is free.

A pad ratio, measured with error, is either the nominal one or any other. The posterior is a mixture
of both, weighed by how well each predicted the measurement (Savage-Dickey density ratio). A number
that cannot be told from nominal stays nominal and does not pay for the noise; one that clearly
differs is taken as measured; in between the interval spans both.
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


class MixturePosterior(NamedTuple):
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
) -> MixturePosterior:
    """Weigh a measured ``deviation`` from nominal, of standard deviation ``sigma``.

    ``free_sigma`` is the spread under the free hypothesis, which must already be part of the
    measurement's posterior; ``odds`` are those of nominal before the measurement; ``nominal_sigma``
    how exactly nominal holds. All of one unit. A deviation far outside ``free_sigma`` is given back
    as measured.
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
    return MixturePosterior(mean, np.sqrt(variance), weight)

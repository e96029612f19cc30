"""The mean of several measured things that differ: a random-effects model.

    x_i = mean + b_i + e_i        b_i ~ N(0, between)        e_i ~ N(0, v_i), v_i known

``between`` by restricted maximum likelihood (REML), which is hardly biased with few things
(Viechtbauer 2005, doi:10.3102/10769986030003261; Veroniki et al. 2016, doi:10.1002/jrsm.1164).
The error of the mean is that of Hartung and Knapp (2001, doi:10.1002/sim.791): from the scatter
itself, with Student's t of k - 1 degrees of freedom, exact where all v_i are equal. It is never
narrower than the normal interval, as it would be for things that agree by chance (Jackson et al.
2017, doi:10.1002/sim.7411).

Not true where the e_i are correlated: add shared errors to the error of the mean, not to v_i.
"""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import Z95

_STEPS = 500  # of the iteration at most; it takes 5 to 50
_SETTLED = 1e-12  # last step over the whole variance


@dataclass(frozen=True)
class RandomEffects:
    """Mean of k things (n,), for each of n quantities, in their units.

    ``sigma`` (n,): standard error, to be used with Student's t of ``freedom`` = k - 1. ``between``
    (n,): variance between the things; ``within`` (n,): mean of their own; ``weights`` (k, n) add up
    to 1.
    """

    mean: Array
    sigma: Array
    between: Array
    within: Array
    weights: Array
    freedom: int

    @property
    def one_more(self) -> Array:
        """Standard deviation about the mean of one more thing that is measured like these.

        To be used with Student's t; exact where all v_i are equal, too wide for its true value.
        """
        return np.sqrt(self.between + self.sigma**2 + self.within)


def random_effects(values: Array, variances: Array, weights: Array | None = None) -> RandomEffects:
    """Mean of ``values`` (k, n) with known ``variances`` (k, n) of their own, k of 2 or more.

    ``weights`` (k,) of the mean, if they are not to be 1/(between + v_i). Raises ValueError for
    fewer than two things.
    """
    x, v = np.asarray(values, float), np.asarray(variances, float)
    freedom = x.shape[0] - 1
    if freedom < 1:
        raise ValueError("one thing alone has no scatter")
    between = between_variance(x, v)
    variance = between + v
    best = 1.0 / np.maximum(variance, _SETTLED * _scale(x, v))
    best = np.asarray(best / best.sum(axis=0))
    w = best if weights is None else np.broadcast_to(weights[:, None] / weights.sum(), x.shape)
    mean = (w * x).sum(axis=0)
    square = (x - (best * x).sum(axis=0)) ** 2
    chi2 = np.divide(square, variance, out=np.zeros_like(x), where=variance > 0.0).sum(axis=0)
    # Hartung and Knapp; at least so much that Student's interval is the normal one
    scatter = np.maximum(chi2 / freedom, (Z95 / quantile95(freedom)) ** 2)
    sigma = np.sqrt(scatter * (w**2 * variance).sum(axis=0))
    return RandomEffects(mean, sigma, between, (w * v).sum(axis=0), w, freedom)


def between_variance(values: Array, variances: Array) -> Array:
    """Variance between things by REML (n,), from ``values`` and ``variances`` (k, n); cut at 0."""
    x, v = np.asarray(values, float), np.asarray(variances, float)
    scale = _scale(x, v)
    between = np.maximum(x.var(axis=0, ddof=1) - v.mean(axis=0), 0.0)
    for _ in range(_STEPS):
        w = 1.0 / np.maximum(between + v, _SETTLED * scale)
        mean = (w * x).sum(axis=0) / w.sum(axis=0)
        # the fixed point of the restricted likelihood
        new = (w**2 * ((x - mean) ** 2 - v)).sum(axis=0) / (w**2).sum(axis=0) + 1.0 / w.sum(axis=0)
        new = np.maximum(new, 0.0)
        converged = np.all(np.abs(new - between) <= _SETTLED * scale)
        between = new
        if converged:
            break
    return np.where(x.var(axis=0) > 0.0, between, 0.0)


def quantile95(freedom: int) -> float:
    """0.975 quantile of Student's t."""
    from scipy.special import stdtrit

    return float(stdtrit(freedom, 0.975))


def as_sigma(t: float, freedom: int) -> float:
    """The quantile of the normal distribution as rare as ``t`` of Student's t."""
    from scipy.special import ndtri, stdtr

    tail = max(float(stdtr(freedom, -abs(t))), 1e-300)  # 37 sigma
    return float(np.copysign(-ndtri(tail), t))


def _scale(x: Array, v: Array) -> Array:
    """Scale of the variances, never zero."""
    whole = x.var(axis=0) + v.mean(axis=0)
    return np.where(whole > 0.0, whole, 1.0)

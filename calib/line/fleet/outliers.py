"""Find the outliers of a fleet; the share of false outliers is limited over the whole fleet.

    distance       |x - median| over the upper quartile of |x - median| on the same side
    p of a metric  two-sided, of a mixture of normal and Student distributions
    p of a car     the least p of its metrics, times the number of metrics (Bonferroni)
    outliers       by the rule of Benjamini and Hochberg (1995) over the cars

Each side of the median has its own spread and tails, so that a skewed metric has no more false
outliers than another. Few cars say little of the tails, so the weights of the distributions are
learnt from all sides of all metrics (empirical Bayes; Efron, Large-Scale Inference, 2010). The
outermost tenth of a side is censored: outliers do not lengthen the tails by which they are judged.
Where at least half of the cars have one value, such as that of a prior, only the others are judged
if they are enough.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array, Index, Mask

_FALSE_SHARE = 0.03
"""Expected share of good cars among the outliers; 3 % of fleets of good cars have an outlier."""
_REASON_P = 0.01
"""A metric of an outlier is a reason if p times the number of metrics is at most this, or at most
the largest p of an outlying car."""
FEWEST = 8  # fewest cars for a spread that can name outliers
_CENSORED = 0.1  # share of the cars of a side that is censored: the outermost
_FREEDOM = np.array([1e6, 8.0, 4.0, 2.5])  # of four Student distributions; 1e6: nearly normal
_QUARTILE = np.array([1.15035, 1.24032, 1.34440, 1.49085])
"""Upper quartile of |t| of each of the four distributions: the quantile 87.5 % of t."""
_PRIOR = np.array([0.50, 0.25, 0.15, 0.10])  # share of each of the four among all sides
_PRIOR_WEIGHT = 0.5
"""Weight of the prior, in sides. With more, a small fleet would hide a car that is 9 sigma off."""
_EM_STEPS = 30  # steps of expectation and maximisation; then the shares are constant


@dataclass(frozen=True)
class OutlierTest:
    """Test of m metrics of n cars; p is NaN where a metric is not known or not judged."""

    p: Array  # two-sided, (m, n)
    reasons: Mask  # whether a car is an outlier by a metric, (m, n)
    p_of_car: Array  # over all metrics of a car, (n,)


def find_outliers(values: Array, least: Sequence[float]) -> OutlierTest:
    """Test ``values`` (m, n) of m metrics of n cars, NaN if a car does not have one.

    ``least`` (m,) is the difference that matters in the unit of each metric, 0 for any.
    """
    from scipy.special import stdtr
    from scipy.stats import false_discovery_control

    sides: list[tuple[int, Index, Array]] = []  # metric, cars and their distances
    for metric, (row, least_spread) in enumerate(zip(values, least, strict=True)):
        sides += [(metric, cars, distance) for cars, distance in _sides(row, least_spread)]
    p = np.full(values.shape, np.nan)
    weights = _tails([distance for _, _, distance in sides])
    for (metric, cars, distance), weight in zip(sides, weights, strict=True):
        t = distance[:, None] * _QUARTILE  # (cars of the side, 4)
        p[metric, cars] = 2.0 * stdtr(_FREEDOM, -t) @ weight

    judged_metrics = len({metric for metric, _, _ in sides})
    bonferroni = np.where(np.isfinite(p), judged_metrics * p, np.inf)
    least_p = bonferroni.min(axis=0, initial=np.inf)
    is_judged = np.isfinite(least_p)
    p_of_car = np.where(is_judged, np.minimum(least_p, 1.0), np.nan)
    is_outlier = is_judged.copy()
    is_outlier[is_judged] = false_discovery_control(p_of_car[is_judged]) <= _FALSE_SHARE
    limit = max(_REASON_P, float(p_of_car[is_outlier].max(initial=0.0)))
    return OutlierTest(p, is_outlier & (bonferroni <= limit), p_of_car)


def _sides(values: Array, least: float) -> list[tuple[Index, Array]]:
    """Return the cars on each side of a metric's median, and their distances.

    There are none for too few cars or without scatter. ``least`` is the least spread of a side.
    """
    cars = np.flatnonzero(np.isfinite(values))
    if cars.size < FEWEST:
        return []
    centre = float(np.median(values[cars]))
    deviation = values[cars] - centre
    equal_up_to = max(least, 1e-12 * abs(centre))  # at least the rounding
    if np.median(np.abs(deviation)) <= equal_up_to:  # half of the cars or more have one value
        differs = np.abs(deviation) > equal_up_to
        if np.count_nonzero(differs) >= FEWEST:
            cars, deviation = cars[differs], deviation[differs]
        elif least <= 0.0:
            return []
        # else all cars are judged, by the least spread
    sides = []
    for side in (deviation < 0.0, deviation >= 0.0):
        is_large = 2 * np.count_nonzero(side) >= FEWEST  # else the spread is that of both sides
        distance = np.abs(deviation[side] if is_large else deviation)
        spread = max(float(np.quantile(distance, 0.75)), least)
        if spread == 0.0:
            spread = float(distance.max())
        sides.append((cars[side], np.abs(deviation[side]) / spread))
    return sides


def _tails(distances: list[Array]) -> Array:
    """Return the weight (s, 4) of each distribution on each of s sides, from the cars of all sides.

    The density of a distance x is q f(q x), with the density f of Student's t and its `_QUARTILE`
    q. A censored car adds the probability of a distance beyond the last one that is not censored.
    """
    from scipy.special import softmax
    from scipy.stats import t

    log_likelihood = np.zeros((len(distances), _FREEDOM.size))
    for i, distance in enumerate(map(np.sort, distances)):
        censored = int(np.ceil(_CENSORED * distance.size))
        if censored < distance.size:
            inside = distance[:-censored, None] * _QUARTILE  # (cars, 4)
            log_density = t.logpdf(inside, _FREEDOM) + np.log(_QUARTILE)
            log_likelihood[i] += np.sum(log_density, axis=0)
            log_likelihood[i] += censored * t.logsf(inside[-1], _FREEDOM)
    share, weights = _PRIOR, log_likelihood
    for _ in range(_EM_STEPS):
        weights = softmax(np.log(share) + log_likelihood, axis=1)
        total = _PRIOR_WEIGHT + len(distances)
        share = (_PRIOR_WEIGHT * _PRIOR + weights.sum(axis=0)) / total
    return weights

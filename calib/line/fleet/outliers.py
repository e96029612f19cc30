"""Outliers of a fleet, with a limited share of false ones over the whole fleet.

    distance       |x - median| over the upper quartile of these on its side of the median
    p of a metric  two-sided, of a mixture of normal and Student distributions
    p of a car     the least p of its metrics, times the number of metrics (Bonferroni)
    outliers       by the rule of Benjamini and Hochberg (1995) over the cars, `_SHARE`

Each side of the median has its own spread and tails, so that a skewed metric has no more false
outliers than another. Few cars say little of their tails, so the weights of the distributions are
learnt from all sides of all metrics (empirical Bayes; Efron, Large-Scale Inference, 2010). The
outermost tenth of a side is censored: outliers do not lengthen the tails by which they are judged.
Where at least half of the cars have one value, such as that of a prior, only the others are judged.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array, Index, Mask

_SHARE = 0.03
"""Expected share of false ones among the outliers, and of normal fleets that have one."""

_REASON = 0.01
"""p, times the number of metrics, at which a further metric of an outlier is a reason, too."""

FEWEST = 8
"""Fewest cars for a scale that can name outliers."""

_OUTSIDE = 0.1
"""Share of the cars of a side that is censored: the outermost."""

_FREEDOM = np.array([1e6, 8.0, 4.0, 2.5])
"""Degrees of freedom of Student's distribution; the first is the normal one."""
_QUARTILE = np.array([1.15035, 1.24032, 1.34440, 1.49085])
"""Upper quartile of one side of each of them: its quantile 87.5 %."""
_PRIOR = np.array([0.50, 0.25, 0.15, 0.10])
"""Prior share of each of them among the sides of all metrics."""
_PRIOR_WEIGHT = 0.5
"""Sides as which the prior counts: with more, cars 9 sigma off hide in small normal fleets."""
_EM_STEPS = 30
"""Steps of expectation and maximisation, after which the shares are constant."""


@dataclass(frozen=True)
class OutlierTest:
    """Test of m metrics of n cars; NaN where a metric is not known or not judged.

    ``p`` (m, n) two-sided; ``reasons`` (m, n) metrics for which a car is an outlier; ``p_of_car``
    (n,) over its metrics.
    """

    p: Array
    reasons: Mask
    p_of_car: Array


def find_outliers(values: Array, least: Sequence[float]) -> OutlierTest:
    """Test ``values`` (m, n) of m metrics of n cars, NaN if a car does not have one.

    ``least`` (m,): differences that matter, in the unit of each metric, 0 for any.
    """
    from scipy.special import stdtr
    from scipy.stats import false_discovery_control

    sides = [
        (i, *side) for i, one in enumerate(zip(values, least, strict=True)) for side in _sides(*one)
    ]
    p, metrics = np.full(values.shape, np.nan), len({i for i, _, _ in sides})
    weights = _tails([distance for _, _, distance in sides])
    for (i, rows, distance), weight in zip(sides, weights, strict=True):
        p[i, rows] = 2.0 * stdtr(_FREEDOM, -distance[:, None] * _QUARTILE) @ weight
    bonferroni = np.where(np.isfinite(p), metrics * p, np.inf)
    least_p = bonferroni.min(axis=0, initial=np.inf)
    p_of_car = np.where(np.isfinite(least_p), np.minimum(least_p, 1.0), np.nan)
    is_judged = np.isfinite(p_of_car)
    cars = is_judged.copy()
    cars[is_judged] = false_discovery_control(p_of_car[is_judged]) <= _SHARE
    limit = max(_REASON, float(p_of_car[cars].max(initial=0.0)))
    return OutlierTest(p, cars & (bonferroni <= limit), p_of_car)


def _sides(values: Array, least: float) -> list[tuple[Index, Array]]:
    """Cars on each side of a metric's median, and their distances over the spread of the side.

    Empty for too few cars or without scatter. A spread is at least ``least``, and that of both
    sides where one has too few cars.
    """
    rows = np.flatnonzero(np.isfinite(values))
    if rows.size < FEWEST:
        return []
    centre = float(np.median(values[rows]))
    away, alike = values[rows] - centre, max(least, 1e-12 * abs(centre))
    if np.median(np.abs(away)) <= alike:  # half of the cars or more are alike: judge the others
        others = np.abs(away) > alike
        if int(others.sum()) >= FEWEST:
            rows, away = rows[others], away[others]
        elif least <= 0.0:
            return []
    sides = []
    for beyond in (away < 0.0, away >= 0.0):
        distance = np.abs(away[beyond] if 2 * int(beyond.sum()) >= FEWEST else away)
        spread = max(float(np.quantile(distance, 0.75)), least) or float(distance.max())
        sides.append((rows[beyond], np.abs(away[beyond]) / spread))
    return sides


def _tails(distances: list[Array]) -> Array:
    """Weight (s, 4) of each of `_FREEDOM` on each side, from its cars and those of all sides."""
    from scipy.special import softmax
    from scipy.stats import t

    fits, share = np.zeros((len(distances), _FREEDOM.size)), _PRIOR
    for fit, x in zip(fits, map(np.sort, distances), strict=True):
        outside = int(np.ceil(_OUTSIDE * x.size))
        if outside < x.size:
            inside, end = x[:-outside, None] * _QUARTILE, x[-outside - 1] * _QUARTILE
            fit += np.sum(t.logpdf(inside, _FREEDOM) + np.log(_QUARTILE), axis=0)
            fit += outside * t.logsf(end, _FREEDOM)
    weights = fits
    for _ in range(_EM_STEPS):
        weights = softmax(np.log(share) + fits, axis=1)
        total = _PRIOR_WEIGHT + len(distances)
        share = (_PRIOR_WEIGHT * _PRIOR + weights.sum(axis=0)) / total
    return weights

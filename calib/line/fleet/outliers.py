"""Cars that stand apart in a fleet, with a limited share of false ones over the whole fleet.

Each metric gives each car a p-value, from what the bulk of the cars says of its scale and, with the
other metrics, of its tails: see `calib.line.fleet.shapes`.

    p of a car     the least p of its metrics, times the number of metrics that say new things
    named cars     by the rule of Benjamini and Hochberg (1995) over the cars, `SHARE`
    edges          how far a car must be, in one metric, to be named for it alone

Metrics that follow each other count as one: that number is the effective one of Galwey (Genetic
Epidemiology 33, 2009). Where half of the cars or more have one value, such as a prior's, the other
cars are judged among themselves. Assumed are good cars with tails about as long as those of a t
distribution with 4 degrees of freedom, or shorter: `tests/studies/results/fleet_alarms.md`.
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.line.fleet.shapes import QUARTILE, TAIL_PRIOR, Bulk

SHARE = 0.03
"""Expected share of false ones among the named cars, and of normal fleets that name a good one.
Fleets with long tails name one more often: with 0.05 more than 8 % of them do."""

_REASON = 0.01
"""p over its metrics at which a further metric of a named car is told as a reason, too."""

_MANY = 30
"""Cars from which on `SHARE` holds; of fewer the tails are so little known that less is named."""

FEWEST = 8
"""Fewest cars for a scale that can name outliers."""

_OUTSIDE = 0.1
"""Share of the cars, the outermost, that must prove that they belong to the bulk."""

_ALONE = 0.03
"""Weight of the prior against what the other metrics say of the tails of this one."""

_SPIKE = 0.05
"""Width of the narrowest half of the cars, over that of 5 to 95 %, below which it is one value."""

_REACH = 1000.0
"""Scales from the median up to which the edges of a metric are sought."""

_MAD = 1.4826


@dataclass(frozen=True)
class MetricSpread:
    """Centre and scale of one metric, and the position of each car.

    ``count`` finite values; ``median``, ``scale`` in the metric's unit; ``z`` (n,) the normal
    number that is as rare, NaN if the metric is not known or not judged; ``p`` two-sided (n,), NaN
    likewise; ``quantiles`` 5, 25, 75 and 95 %; ``edges``: a car below the first or above the second
    is named for this metric alone, None if the metric is not judged.
    """

    count: int
    median: float
    scale: float
    z: Array
    p: Array
    quantiles: tuple[float, ...]
    edges: tuple[float, float] | None


@dataclass(frozen=True)
class _Judged:
    """All metrics of a fleet: ``spreads``; ``named`` (m, n) the reasons for which a car is named.

    ``p`` (n,) of each car over its metrics.
    """

    spreads: tuple[MetricSpread, ...]
    named: Mask
    p: Array


def judge(values: Array, least: Sequence[float] | None = None) -> _Judged:
    """Judge ``values`` (m, n) of m metrics of n cars, NaN if a car does not have one.

    ``least`` (m,): differences that matter, in the unit of each metric; none without it.
    """
    m, n = values.shape
    started = [_start(x, at) for x, at in zip(values, least or [0.0] * m, strict=True)]
    known = [i for i, metric in enumerate(started) if metric is not None]
    together = effective(values[known])
    metrics, priors = _grown([x for x in started if x is not None], together, _share(n) / n)
    p = np.full((m, n), np.nan)
    for i, metric, prior in zip(known, metrics, priors, strict=True):
        p[i, metric.rows] = metric.bulk.two_sided(prior, metric.distance)
    car = np.full(n, np.nan)
    some = np.isfinite(p).any(axis=0)
    car[some] = np.minimum(together * np.nanmin(p[:, some], axis=0), 1.0)
    cars = named(car, _share(n))
    limit = max(_REASON, float(car[cars].max())) if cars.any() else 0.0
    # what the rule asks of the last car that it names, or of the first one
    edge = _share(n) * max(int(cars.sum()), 1) / max(int(some.sum()), 1) / max(together, 1.0)
    edges = {i: m.edges(prior, edge) for i, m, prior in zip(known, metrics, priors, strict=True)}
    spreads = tuple(_spread(values[i], p[i], edges.get(i)) for i in range(m))
    return _Judged(spreads, cars & (together * np.nan_to_num(p, nan=1.0) <= limit), car)


def named(p: Array, share: float = SHARE) -> Mask:
    """Which of ``p`` (any shape) are discoveries by Benjamini and Hochberg; NaN never is.

    >>> named(np.array([0.001, 0.02, 0.9, 0.04]), 0.05)
    array([ True,  True, False, False])
    """
    from scipy.stats import false_discovery_control

    known = np.isfinite(p)
    out = np.zeros(p.shape, dtype=np.bool_)
    out[known] = false_discovery_control(p[known]) <= share
    return out


def _share(n: int) -> float:
    return SHARE * min(1.0, n / _MANY)


def effective(values: Array) -> float:
    """Number of metrics that say new things: m if none follows another, 1 if all are one.

    ``values`` (m, n). A correlation that chance gives among n cars counts as zero.
    """
    m, n = values.shape
    if m < 2:
        return float(m)
    from scipy.stats import rankdata

    ranks = np.array([rankdata(x, nan_policy="omit") for x in values])
    ranks -= np.nanmean(ranks, axis=1, keepdims=True)
    ranks = np.nan_to_num(ranks)
    size = np.sqrt(np.sum(ranks**2, axis=1))
    r = ranks @ ranks.T / np.maximum(np.outer(size, size), 1e-300)
    r[np.abs(r) < 3.0 / np.sqrt(n)] = 0.0
    np.fill_diagonal(r, 1.0)
    strength = np.maximum(np.linalg.eigvalsh(r), 0.0)
    return float(np.sum(np.sqrt(strength)) ** 2 / np.sum(strength))


@dataclass(frozen=True)
class _Metric:
    """A metric while it is judged.

    ``distance`` of its judged cars from ``centre``; ``inside``: those in the bulk.
    """

    rows: Index
    centre: float
    distance: Array
    scale: float
    inside: Mask

    @cached_property
    def bulk(self) -> Bulk:
        x = self.distance[self.inside]
        out = self.distance[~self.inside]
        low, high = float(x.min()), float(x.max())
        return Bulk(np.sort(x), self.scale, low, high, int(np.sum(out < 0)), int(np.sum(out > 0)))

    def grown(self, prior: Array, limit: float) -> "_Metric":
        """With the likelier half of the cars outside in the bulk, if they belong to it.

        So the farthest car is judged by all others.
        """
        out = np.flatnonzero(~self.inside)
        p = self.bulk.two_sided(prior, self.distance[out])
        likelier = np.argsort(-p, kind="stable")[: (out.size + 1) // 2]
        belongs = out[likelier[p[likelier] >= limit]]
        if not belongs.size:
            return self
        inside = self.inside.copy()
        inside[belongs] = True
        return replace(self, inside=inside)

    def edges(self, prior: Array, limit: float) -> tuple[float, float]:
        """Values at which p is ``limit`` for a car that is not in the bulk.

        Infinite past `_REACH` scales.
        """
        far = self.scale * np.geomspace(0.3, _REACH, 600)
        below = replace(self.bulk, below=max(self.bulk.below, 1))
        above = replace(self.bulk, above=max(self.bulk.above, 1))
        ends = []
        for side, bulk in ((-1.0, below), (1.0, above)):
            rare = np.flatnonzero(bulk.two_sided(prior, side * far) <= limit)
            ends.append(self.centre + side * float(far[rare[0]]) if rare.size else side * np.inf)
        return ends[0], ends[1]


def _grown(
    metrics: list[_Metric], together: float, share: float
) -> tuple[list[_Metric], list[Array]]:
    """The metrics with all cars in the bulk that belong to it, and the priors of their tails."""
    while True:
        priors = _priors([metric.bulk.evidence for metric in metrics], together)
        limit = share / max(together, 1.0)
        grown = [m.grown(prior, limit) for m, prior in zip(metrics, priors, strict=True)]
        if all(a is b for a, b in zip(grown, metrics, strict=True)):
            return metrics, priors
        metrics = grown


def _start(values: Array, least: float) -> _Metric | None:
    """The metric with its outermost cars outside; None if it cannot be judged."""
    rows = np.flatnonzero(np.isfinite(values))
    centre = 0.0
    for _ in range(2):
        x = values[rows]
        if rows.size < FEWEST:
            return None
        low, high = _narrowest_half(x)
        five, ninety = np.quantile(x, [0.05, 0.95])
        if high - low > max(_SPIKE * (ninety - five), least):
            break
        if ninety - five <= least:  # all cars alike: none is far unless it matters
            break
        # one value of half of the cars: the others are judged about it
        centre = 0.5 * (low + high)
        rows = rows[np.abs(values[rows] - centre) > max(0.5 * (high - low), least)]
    else:
        return None
    spiked = rows.size < np.isfinite(values).sum()
    centre = centre if spiked else float(np.median(values[rows]))
    x = values[rows] - centre
    quarter = np.quantile(np.abs(x) if spiked else x, [0.25, 0.5, 0.75])
    half = quarter[1] if spiked else 0.5 * (quarter[2] - quarter[0])
    scale = max(float(half) / QUARTILE, least, 1e-12 * abs(float(np.median(values[rows]))))
    if scale <= 1e-12 * abs(float(np.median(values[rows]))):
        return None
    outside = max(1, int(np.ceil(_OUTSIDE * x.size)))
    up, down = max(quarter[2], scale / 2), max(-quarter[0], scale / 2)
    far = np.where(x > 0, x / up, -x / (up if spiked else down))
    inside = np.ones(x.size, dtype=np.bool_)
    inside[np.argsort(far, kind="stable")[-outside:]] = False
    return _Metric(rows, centre, x, scale, inside)


def _narrowest_half(x: Array) -> tuple[float, float]:
    """Ends of the narrowest interval that holds half of ``x``."""
    ordered = np.sort(x)
    k = (x.size + 1) // 2
    width = ordered[k - 1 :] - ordered[: x.size - k + 1]
    i = int(np.argmin(width))
    return float(ordered[i]), float(ordered[i + k - 1])


def _priors(evidences: list[Array], together: float) -> list[Array]:
    """Weight of each h for each metric: that of the prior, and what the other metrics say."""
    every = np.sum(evidences, axis=0)
    out = []
    for own in evidences:
        others = (every - own) * together / len(evidences) + np.log(TAIL_PRIOR)
        said = np.exp(others - others.max())
        out.append(_ALONE * TAIL_PRIOR + (1.0 - _ALONE) * said / said.sum())
    return out


def _spread(values: Array, p: Array, edges: tuple[float, float] | None) -> MetricSpread:
    from scipy.special import ndtri

    known = values[np.isfinite(values)]
    if known.size == 0:
        return MetricSpread(0, np.nan, np.nan, p, p, (np.nan,) * 4, None)
    median = float(np.median(known))
    scale = _MAD * float(np.median(np.abs(known - median)))
    z = -np.sign(values - median) * ndtri(np.maximum(0.5 * p, 1e-19))
    quantiles = tuple(map(float, np.quantile(known, [0.05, 0.25, 0.75, 0.95])))
    return MetricSpread(known.size, median, scale, z, p, quantiles, edges)

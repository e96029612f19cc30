"""Drift of the production line: a test for one change of level.

The test of Pettitt (Applied Statistics 28, 1979) over the whole order, by ranks, so for any
distribution:

    K = max_k |S_k|,   S_k = sum of (rank - mean rank) up to car k

Logs of one car are alike without a drift. So K is divided by sqrt((1 + r)/(1 - r)) (Bayley and
Hammersley, Supplement to the J. of the Royal Statistical Society 8, 1946), where r is the lag-1
autocorrelation without the drift (Serinaldi and Kilsby, Stochastic Environmental Research and Risk
Assessment 30, 2016). Valid for up to about four logs a car, and from ten cars on.
"""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array

FEWEST = 22
"""Fewest logs that are tested: of a plain step p is then 0.0007, enough among ten metrics."""

_MOST_CORRELATION = 0.95
"""Largest lag-1 autocorrelation that is used: 39 logs then count as one."""


@dataclass(frozen=True)
class LevelChange:
    """A change of level: ``first`` index of the new level, medians on both sides, p-value ``p``."""

    first: int
    old_level: float
    new_level: float
    p: float


def find_change(values: Array) -> LevelChange | None:
    """Test ``values`` (n,) in order for one change of level; None below `FEWEST` or all equal.

    ``p`` is by Kolmogorov's distribution, exact for many cars and too large for few; ``first`` is
    near the middle of a slow drift.
    """
    n = values.size
    if n < FEWEST or np.ptp(values) == 0.0:
        return None
    from scipy.special import kolmogorov
    from scipy.stats import rankdata

    ranks = rankdata(values) - 0.5 * (n + 1)
    S = np.abs(np.cumsum(ranks)[:-1])
    k = int(np.argmax(S))
    r = autocorrelation(ranks, k + 1)
    scale = np.sqrt(np.sum(ranks**2) * n / (n - 1) * (1.0 + r) / (1.0 - r))
    old_level, new_level = (float(np.median(part)) for part in np.split(values, [k + 1]))
    return LevelChange(k + 1, old_level, new_level, float(kolmogorov(S[k] / scale)))


def autocorrelation(ranks: Array, first: int) -> float:
    """Lag-1 autocorrelation of ``ranks`` (n,) about their mean, 0 to `_MOST_CORRELATION`.

    That of the residual of a step at ``first``, or of a straight line if this fits better; without
    its bias -(2 + 4 r)/n (van Giersbergen, Economics Letters 86, 2005).
    """
    n = ranks.size
    step = np.concatenate([part - part.mean() for part in np.split(ranks, [first])])
    index = np.arange(n) - 0.5 * (n - 1)
    line = ranks - index * float(index @ ranks) / float(index @ index)
    residual = min(step, line, key=lambda x: float(x @ x))
    size = float(residual @ residual)
    if size <= 1e-12 * float(ranks @ ranks):
        return 0.0
    r = float(residual[1:] @ residual[:-1]) / size
    return min(max((n * r + 2.0) / (n - 4.0), 0.0), _MOST_CORRELATION)

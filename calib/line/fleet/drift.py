"""Drift of the production line: a test for one change of level.

The test of Pettitt (Applied Statistics 28, 1979) over the whole order, by ranks, so for any
distribution:

    K = max_k |S_k|,   S_k = sum of (rank - mean rank) up to car k

Neighbours may be alike without a drift: logs of one car. K is divided by sqrt((1 + r)/(1 - r))
(Bayley and Hammersley, Supplement to the J. of the Royal Statistical Society 8, 1946), r the
correlation of neighbours without the drift itself (Serinaldi and Kilsby, Stochastic Environmental
Research and Risk Assessment 30, 2016): good for up to about four logs a car and ten cars.
"""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array

FEWEST = 22
"""Fewest logs that are tested: of a plain step p is then 0.0007, enough among ten metrics."""

_ALIKE = 0.95
"""Largest correlation of neighbours that is counted: 39 logs then say as much as one."""


@dataclass(frozen=True)
class LevelChange:
    """A change of level: ``first`` index of the new level, medians on both sides, p-value ``p``."""

    first: int
    old_level: float
    new_level: float
    p: float


def change(values: Array) -> LevelChange | None:
    """Test ``values`` (n,) in order for one change of level; None below `FEWEST` or all equal.

    ``p`` is the tail of Kolmogorov's distribution, exact for many cars and too large for few. Of a
    slow drift ``first`` is near its middle.
    """
    n = values.size
    if n < FEWEST or np.ptp(values) == 0.0:
        return None
    from scipy.special import kolmogorov
    from scipy.stats import rankdata

    about = rankdata(values) - 0.5 * (n + 1)
    S = np.abs(np.cumsum(about)[:-1])
    k = int(np.argmax(S))
    r = likeness(about, k + 1)
    scale = np.sqrt(np.sum(about**2) * n / (n - 1) * (1.0 + r) / (1.0 - r))
    old_level, new_level = (float(np.median(part)) for part in np.split(values, [k + 1]))
    return LevelChange(k + 1, old_level, new_level, float(kolmogorov(S[k] / scale)))


def likeness(ranks: Array, first: int) -> float:
    """Correlation of neighbours in ``ranks`` (n,) about their mean, from 0 to `_ALIKE`.

    What is left of a step at ``first``, or of a straight line if that explains more. The estimate
    is too small by (2 + 4 r)/n (van Giersbergen, Economics Letters 86, 2005), which is taken out.
    """
    n = ranks.size
    step = np.concatenate([part - part.mean() for part in np.split(ranks, [first])])
    along = np.arange(n) - 0.5 * (n - 1)
    line = ranks - along * float(along @ ranks) / float(along @ along)
    residual = min(step, line, key=lambda x: float(x @ x))
    size = float(residual @ residual)
    if size <= 1e-12 * float(ranks @ ranks):
        return 0.0
    r = float(residual[1:] @ residual[:-1]) / size
    return min(max((n * r + 2.0) / (n - 4.0), 0.0), _ALIKE)

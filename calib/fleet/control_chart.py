"""Does the line drift: individuals chart with run rules, and a test for a change of level.

The chart (Shewhart; Western Electric, Statistical Quality Control Handbook, 1956) shows where to
look. On a steady line it alarms all the same, with known limits by rule 1 once in 370 cars, by the
four together once in 92 (Champ and Woodall, Technometrics 29, 1987), so on a large fleet an alarm
proves nothing. Limits from the line itself alarm otherwise while it is short: rule 1 of 50 cars
twice as often, rule 4 less than half as often. What decides is one test over the whole order:
Pettitt's (Applied Statistics 28, 1979), on ranks, which no outlier and no odd distribution
misleads.

    K = max_k |S_k|,   S_k = sum of (rank - mean rank) up to car k

Both take cars of a steady line as independent of each other.
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

RULES = {
    1: "one car beyond 3 sigma",
    2: "two of three beyond 2 sigma on one side",
    3: "four of five beyond 1 sigma on one side",
    4: "eight in a row on one side",
}

BY_CHANCE = {1: 0.0027, 2: 0.00205, 3: 0.00447, 4: 0.00781}
"""Share of cars at which each rule is broken on a steady, normal line of known limits."""

FEWEST_BY_CHANCE = 200
"""Cars from which `BY_CHANCE`, that of known limits, holds within a quarter for a `Chart`."""

FEWEST = 10
"""Cars below which there is no chart."""

_MEDIAN_RANGE = 0.9539
"""Median of |x - y| over sigma, x and y normal: sqrt(2) times the upper quartile 0.6745."""


@dataclass(frozen=True)
class Chart:
    """One metric in order.

    ``centre``, ``sigma`` in the metric's unit, from the median and the median moving range;
    ``alarms`` by rule, each (n,), True at the car that completes the pattern.
    """

    centre: float
    sigma: float
    alarms: dict[int, Mask]

    @property
    def limits(self) -> tuple[float, float]:
        """Control limits: centre less and plus 3 sigma."""
        return self.centre - 3.0 * self.sigma, self.centre + 3.0 * self.sigma


@dataclass(frozen=True)
class LevelChange:
    """A change of level: ``first`` index of the new level, medians on both sides, ``p`` of it."""

    first: int
    before: float
    after: float
    p: float


def chart(values: Array) -> Chart | None:
    """Individuals chart of ``values`` (n,) in order, all finite; None below `FEWEST` or no scatter.

    Centre and sigma are of the same cars, so the chart judges evenness, not a target. Sigma is that
    from car to car: a slow drift does not widen it.
    """
    if values.size < FEWEST:
        return None
    moving = np.abs(np.diff(values))
    sigma = float(np.median(moving)) / _MEDIAN_RANGE
    if sigma <= 0.0:  # coarse metrics: most neighbours are equal
        sigma = float(np.mean(moving)) / 1.128
    centre = float(np.median(values))
    if sigma <= 1e-12 * abs(centre):
        return None
    return Chart(centre, sigma, alarms((values - centre) / sigma))


def alarms(z: Array) -> dict[int, Mask]:
    """Run rules 1 to 4 on standardised values ``z`` (n,); each mask is True where one completes."""
    return {
        1: np.asarray(np.abs(z) > 3.0),
        2: _either_side(z, 2.0, 2, 3),
        3: _either_side(z, 1.0, 4, 5),
        4: _either_side(z, 0.0, 8, 8),
    }


def _either_side(z: Array, level: float, wanted: int, window: int) -> Mask:
    return np.asarray(
        _enough(z > level, wanted, window) | _enough(z < -level, wanted, window), dtype=np.bool_
    )


def _enough(hit: Mask, wanted: int, window: int) -> Mask:
    """Where ``hit`` is the last of ``wanted`` hits among ``window`` values."""
    total = np.concatenate([np.zeros(window), np.cumsum(hit)])
    return np.asarray(hit & (total[window:] - total[:-window] >= wanted))


def change(values: Array) -> LevelChange | None:
    """Test ``values`` (n,) in order for one change of level; None below `FEWEST` or all equal.

    ``p`` is the tail of Kolmogorov's law, exact for many cars and cautious for few, see `least_p`.
    A slow drift is found as well; ``first`` is then somewhere in its middle.
    """
    n = values.size
    if n < FEWEST:
        return None
    from scipy.special import kolmogorov
    from scipy.stats import rankdata

    ranks = rankdata(values)
    about = ranks - 0.5 * (n + 1)
    scale = float(np.sqrt(np.sum(about**2) * n / (n - 1)))
    if scale == 0.0:
        return None
    S = np.cumsum(about)[:-1]
    k = int(np.argmax(np.abs(S)))
    p = float(kolmogorov(abs(float(S[k])) / scale))
    return LevelChange(
        k + 1, float(np.median(values[: k + 1])), float(np.median(values[k + 1 :])), p
    )


def least_p(n: int) -> float:
    """The ``p`` of the plainest `change` that ``n`` different values can show.

    That is a step where the greater half of them comes last.

    >>> [round(least_p(n), 4) for n in (10, 14, 16, 22)]
    [0.0661, 0.0149, 0.0071, 0.0007]
    """
    from scipy.special import kolmogorov

    half = n // 2
    # |S_half| of the ranks 1 to n in order, over its scale
    return float(kolmogorov(0.5 * half * (n - half) / np.sqrt(n * n * (n + 1) / 12.0)))

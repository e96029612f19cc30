"""Physical tests for the columns of a braked car.

speed        the four wheels and the car agree
a_x          is the derivative of speed, up to a sign
pressure     comes before the deceleration, and both rise and fall together
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.run.filters import centred_mean, runs

Array = NDArray[np.float64]

SMOOTH = 0.2
"""Width [s] over which a speed is smoothed before it is differentiated."""
LAG = 0.5
"""Longest lag that is tried [s]: a brake builds up in 0.1 to 0.2 s."""
LATE = 0.06
"""A pressure may be later than its effect by this [s], because sensor filters differ."""
SLOW = 0.15
"""Share of the highest speed [1] below which samples are not used: the car is about to stop."""
TOGETHER, RATIO = 0.99, 0.1
"""Lowest correlation of two wheels, and largest relative difference of their means [1]."""


@dataclass(frozen=True)
class ColumnClock:
    """Time of each row, shape (n,), and the mean step [s]."""

    time: Array
    step: float

    def width(self, seconds: float) -> int:
        """Number of samples in ``seconds`` [s], at least 1."""
        return max(1, round(seconds / self.step))


def together(four: list[Array]) -> bool:
    """Whether four speeds are of one car: similar means, high correlation."""
    means = [float(np.mean(x)) for x in four]
    if min(means) <= 0.0 or max(means) > (1.0 + RATIO) * min(means):
        return False
    if any(np.ptp(x) == 0.0 for x in four):
        return False
    steady = max(float(np.std(x)) for x in four) < 0.02 * max(means)  # constant: no correlation
    return steady or float(np.corrcoef(four).min()) > TOGETHER


def rate_of(speed: Array, clock: ColumnClock) -> Array:
    """Derivative of a speed, smoothed over `SMOOTH` [unit/s]."""
    width = clock.width(SMOOTH) | 1
    return centred_mean(np.gradient(centred_mean(speed, width), clock.time), width)


def correlation(a: Array, b: Array) -> float:
    """Correlation of ``a`` and ``b``, both (n,) [1]; 0 if one of them is constant."""
    if np.ptp(a) == 0.0 or np.ptp(b) == 0.0:
        return 0.0
    return float(np.corrcoef(a, b)[0, 1])


def slope(y: Array, x: Array) -> float:
    """Least-squares slope of y over x, both (n,) [unit of y/unit of x]."""
    return float(np.cov(y, x)[0, 1] / np.var(x, ddof=1))


def lead(first: Array, then: Array, clock: ColumnClock, latest: float = LAG) -> tuple[float, float]:
    """Time by which ``first`` leads ``then`` [s], and their correlation at that lag [1].

    ``first`` may be later by at most ``latest`` [s]. The lag is uncertain for a slow ramp alone.
    """
    reach = min(clock.width(LAG), first.size // 4)
    back = min(reach, round(latest / clock.step))
    best = max(range(-back, reach + 1), key=lambda k: _lagged(first, then, k))
    return best * clock.step, _lagged(first, then, best)


def _lagged(first: Array, then: Array, k: int) -> float:
    n = first.size
    return correlation(first[max(0, -k) : n - max(0, k)], then[max(0, k) : n - max(0, -k)])


def moving(speed: Array, clock: ColumnClock) -> slice:
    """The longest part in which the car moves, without the ends that smoothing distorts."""
    fast = speed > SLOW * float(speed.max())
    start, end = max(runs(fast), key=lambda run: run[1] - run[0], default=(0, speed.size))
    margin = 2 * clock.width(SMOOTH)
    whole = end - start > 6 * margin
    return slice(start + margin, end - margin) if whole else slice(start, end)

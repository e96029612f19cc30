"""Whether two logs are one run: saved in another format, rounded, cut or resampled.

Two runs have noise of their own, also where a robot drives them alike; a copy has that of its
original. So the logs are laid over each other, with the lag at which their wheel speeds agree best,
and what is between them is held against their noise:

    D = spread of (a - b), squared, over sigma_a^2 + sigma_b^2     one run: 0 to 0.7; two: 1 or more

It is computed from samples, of which a copy may have left out some, and from means over 50 ms, of
which a copy may be made. Wrong where most channels of a copy are rounded to more than five times
their noise: the noise is lost then, and the runs count as two.
"""

import math

import numpy as np
from numpy.typing import NDArray

from calib.checks.sensors import resolution_of
from calib.logs.log import Log
from calib.names import WHEELS
from calib.physics.lag import integral

Array = NDArray[np.float64]

GRID = 0.01
"""Shortest step at which samples are compared [s]."""

MEANS = 0.05
"""Length of the means that are compared [s]."""

OVERLAP = 0.5
"""Share of the shorter log that must lie within the other one."""

ALIKE = 0.75
"""Median of D over the channels below which two logs are one run. Of white noise, means of two
samples make 0.33, of five 0.67; two runs of one motion make 1 (`tests/checks/test_same_run.py`)."""

FAR = 1e3
"""D of the wheel speeds past which nothing further is compared: a lag of half a step makes 100."""

FEWEST = 20
"""Samples that must lie over each other."""

NORMAL = 1.4826
"""Standard deviation over the median of the absolute values, of normal noise [1]."""

COMPARED = ("p_mc", "a_x", *(f"omega_{w}" for w in WHEELS), "v")

View = dict[str, Array]
"""Channels on an even clock, and the mean of the ``wheels``."""


def same_run(one: Log, other: Log) -> bool:
    """Whether two logs hold one run, or parts of it that overlap by half of the shorter one."""
    if one.digest and one.digest == other.digest:
        return True
    step = max(one.sample_time, other.sample_time)
    return _agree(one, other, max(GRID, step), means=False) or _agree(
        one, other, max(MEANS, 2.0 * step), means=True
    )


def _agree(one: Log, other: Log, step: float, *, means: bool) -> bool:
    """Whether the channels agree, laid over each other where the wheel speeds agree best.

    The lag need not be a whole number of steps.
    """
    a, b = _view(one, step, means), _view(other, step, means)
    if min(a["wheels"].size, b["wheels"].size) < FEWEST:
        return False
    lag, part = _best_lag(a["wheels"], b["wheels"])
    if _apart(a["wheels"], b["wheels"], lag) > FAR:
        return False
    if _alike(a, b, lag):
        return True
    return _alike(a, _view(other, step, means, -part % 1.0 * step), lag + int(np.ceil(part)))


def _view(log: Log, step: float, means: bool, offset: float = 0.0) -> View:
    """The channels every ``step`` [s] from ``offset`` [s] on: interpolated, or means of a step."""
    time = np.arange(log.time[0] + offset, log.time[-1] + 1e-9, step)
    channels = {}
    for name in COMPARED:
        if name in log:
            x = integral(log.time, log[name]) if means else log[name]
            at = np.interp(time, log.time, x)
            channels[name] = np.diff(at) / step if means else at
    return channels | {"wheels": np.mean([channels[f"omega_{w}"] for w in WHEELS], axis=0)}


def _alike(one: View, other: View, lag: int) -> bool:
    """Whether D says so, where ``other`` begins ``lag`` samples after ``one``."""
    changes = [
        name
        for name in COMPARED
        if name in one and name in other and np.ptp(one[name]) + np.ptp(other[name]) > 0.0
    ]
    apart = [_apart(one[name], other[name], lag) for name in changes]
    return bool(apart) and float(np.median(apart)) < ALIKE


def _apart(one: Array, other: Array, lag: int) -> float:
    """D of a channel."""
    a, b = one[max(lag, 0) :], other[max(-lag, 0) :]
    n = min(a.size, b.size)
    between = _spread(a[:n] - b[:n]) ** 2
    noise = _noise(one) ** 2 + _noise(other) ** 2
    if noise == 0.0:
        return 0.0 if between == 0.0 else np.inf
    return between / noise


def _spread(x: Array) -> float:
    """Standard deviation from zero of most of the values: where a braking begins, lags count."""
    return float(NORMAL * np.median(np.abs(x)))


def _noise(x: Array) -> float:
    """Standard deviation of the noise of a channel and of its rounding, by third differences."""
    return max(_spread(np.diff(x, 3)) / math.sqrt(20.0), resolution_of(x) / math.sqrt(12.0))


def _best_lag(a: Array, b: Array) -> tuple[int, float]:
    """The lag of ``b`` in ``a`` at which the mean square between them is least.

    In whole steps, and what a parabola through the neighbours adds to it [1].
    """
    least = max(FEWEST, int(OVERLAP * min(a.size, b.size)))
    centre = float(a.mean())
    a, b = a - centre, b - centre
    lags = np.arange(least - b.size, a.size - least + 1)
    size = 1 << int(np.ceil(np.log2(a.size + b.size)))
    product = np.fft.irfft(np.fft.rfft(a, size) * np.conj(np.fft.rfft(b, size)), size)[lags]
    first, last = np.maximum(lags, 0), np.minimum(lags + b.size, a.size)
    squares = [np.concatenate([[0.0], np.cumsum(x**2)]) for x in (a, b)]
    total = squares[0][last] - squares[0][first]
    total += squares[1][last - lags] - squares[1][first - lags]
    between = (total - 2.0 * product) / (last - first)
    i = int(np.clip(np.argmin(between), 1, lags.size - 2))
    before, at, after = between[i - 1 : i + 2]
    bent = before - 2.0 * at + after
    return int(lags[i]), 0.5 * float(before - after) / bent if bent > 0.0 else 0.0

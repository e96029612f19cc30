"""Means, low-pass and intervals of a sampled signal."""

from functools import lru_cache

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.intervals import QUARTILE


def block_mean(x: Array, size: int) -> Array:
    """Means over blocks of ``size`` samples along the last axis; a shorter rest is left out.

    >>> block_mean(np.array([1.0, 3.0, 5.0, 7.0, 9.0]), 2)
    array([2., 6.])
    """
    count = x.shape[-1] // size
    blocks = x[..., : count * size].reshape(*x.shape[:-1], count, size)
    return np.asarray(blocks @ np.ones(size) / size)  # eight times as fast as a mean of short rows


def third_difference(x: Array, lag: int) -> Array:
    """Third differences (n - 3 lag,) over ``lag`` samples each: they hold almost no motion.

    Of white noise they have 20 times its variance.

    >>> third_difference(np.array([0.0, 1.0, 4.0, 9.0, 17.0]), 1)
    array([0., 1.])
    """
    a, b, c, d = (x[i * lag : x.size - (3 - i) * lag] for i in range(4))
    return np.asarray(d - 3.0 * c + 3.0 * b - a)


def typical_differences(x: Array, longest: float) -> list[float]:
    """Sd of the third differences over 1, 2, 4 ... up to ``longest`` samples, from their median.

    A bite moves few of them. No lag that is longer than a third of ``x`` (n,).
    """
    found, lag = [], 1
    while lag <= longest and 3 * lag < x.size:
        found.append(float(np.median(np.abs(third_difference(x, lag)))) / QUARTILE)
        lag *= 2
    return found


def trailing_mean(x: Array, width: int) -> Array:
    """Mean of the last ``width`` samples, fewer at the start. Shape (n,)."""
    total = np.cumsum(np.concatenate([[0.0], x]))
    stop = np.arange(1, x.size + 1)
    start = np.maximum(stop - width, 0)
    return np.asarray((total[stop] - total[start]) / (stop - start))


def centred_mean(x: Array, width: int, *, held_ends: bool = False) -> Array:
    """Mean over the ``width`` samples around each. Shape (n,).

    An even width has one sample more before than after. At both ends the mean is over fewer
    samples; with ``held_ends`` it is over ``width``, with the first or last sample repeated.

    >>> centred_mean(np.array([0.0, 3.0, 6.0]), 3)
    array([1.5, 3. , 4.5])
    >>> centred_mean(np.array([0.0, 3.0, 6.0]), 3, held_ends=True)
    array([1., 3., 5.])
    """
    if held_ends:
        before = width // 2
        padded = np.pad(x, (before, width - 1 - before), "edge")
        total = np.cumsum(np.concatenate([[0.0], padded]))
        return np.asarray((total[width:] - total[:-width]) / width)
    low, high, count = _window(x.size, width)
    total = np.concatenate([[0.0], np.cumsum(x)])
    return np.asarray((total[high] - total[low]) / count)


@lru_cache(maxsize=8)
def _window(size: int, width: int) -> tuple[Index, Index, Array]:
    """Start, end (exclusive) and number of the samples around each sample; cached."""
    first = np.arange(size) - width // 2
    low, high = np.maximum(first, 0), np.minimum(first + width, size)
    return low, high, (high - low).astype(np.float64)


def low_pass(x: Array, step: float, time_constant: float) -> Array:
    """First-order causal low-pass of ``x`` (n,), started at its first value.

    ``step`` and ``time_constant`` [s]. The input is constant between samples; for an input that is
    linear between samples, use `calib.car.lag.first_order`.
    """
    from scipy.signal import lfilter

    gain = 1.0 - float(np.exp(-step / time_constant))
    start = [(1.0 - gain) * x[0]]
    return np.asarray(lfilter([gain], [1.0, gain - 1.0], x, zi=start)[0])


def since(time: Array, event: Mask) -> Array:
    """Time since the ``event`` last held [s] (n,); infinite before its first.

    >>> since(np.array([0.0, 1.0, 2.0]), np.array([False, True, False]))
    array([inf,  0.,  1.])
    """
    return np.asarray(time - np.maximum.accumulate(np.where(event, time, -np.inf)))


def without_single(x: Array) -> Array:
    """Values (n,) without single ones that both neighbours disagree with: the median of three.

    A wheel that slips deeply does so for 50 ms or more; one sample alone is an error of the bus.

    >>> without_single(np.array([3.0, 3.0, 0.0, 3.0, 2.0, 1.0]))
    array([3., 3., 3., 2., 2., 1.])
    """
    before, here, after = x[:-2], x[1:-1], x[2:]
    low, high = np.minimum(before, here), np.maximum(before, here)
    return np.concatenate([x[:1], np.maximum(low, np.minimum(high, after)), x[-1:]])


def runs(mask: Mask, least: int = 1) -> list[tuple[int, int]]:
    """Start and end (exclusive) of each run of at least ``least`` samples with a true ``mask``.

    >>> runs(np.array([False, True, True, False, True]))
    [(1, 3), (4, 5)]
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    first, last = edges[::2], edges[1::2]
    long = last - first >= least
    return list(zip(first[long].tolist(), last[long].tolist(), strict=True))

"""Means, low-pass and intervals of a sampled signal, and residuals of many least squares."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from calib.base.arrays import Array, Index, Mask


def samples_in(time: float, step: float) -> int:
    """Samples of a ``step`` [s] in a ``time`` [s], at least one."""
    return max(1, round(time / step))


def block_mean(x: Array, size: int) -> Array:
    """Means over blocks of ``size`` samples along the last axis; a shorter rest is left out.

    >>> block_mean(np.array([1.0, 3.0, 5.0, 7.0, 9.0]), 2)
    array([2., 6.])
    """
    count = x.shape[-1] // size
    blocks = x[..., : count * size].reshape(*x.shape[:-1], count, size)
    return np.asarray(blocks @ np.ones(size) / size)  # eight times as fast as a mean of short rows


class GroupMean:
    """Means over groups of samples of any size, each given by the indices of its samples.

    >>> GroupMean([np.array([0, 1]), np.array([3])])(np.array([1.0, 3.0, 5.0, 7.0]))
    array([2., 7.])
    """

    def __init__(self, groups: Sequence[Index]) -> None:
        self.sizes = np.array([group.size for group in groups])
        self._places, self._first = np.concatenate(groups), np.cumsum(self.sizes) - self.sizes

    def __call__(self, x: Array) -> Array:
        """Mean of ``x`` (..., n) over each group."""
        of_groups = x.take(self._places, axis=-1)
        return np.asarray(np.add.reduceat(of_groups, self._first, axis=-1) / self.sizes)


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
        margin = width // 2
        padded = np.pad(x, (margin, width - 1 - margin), "edge")
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
    """First-order causal low-pass of ``x`` (n,), started at its first value; times in s.

    The input is constant between samples; `calib.car.lag.first_order` takes it as linear.
    """
    gain = 1.0 - float(np.exp(-step / time_constant))
    return recursive(np.append(x[:1], gain * x[1:]), [1.0, gain - 1.0])


def recursive(x: Array, poles: Sequence[float] | Array) -> Array:
    """Output y of y[k] + poles[1] y[k-1] + poles[2] y[k-2] + ... = x[k], from rest, (..., n).

    Solved as a banded system: importing `scipy.signal` takes longer than estimating a log.

    >>> recursive(np.array([1.0, 0.0, 0.0]), [1.0, -0.5])
    array([1.  , 0.5 , 0.25])
    """
    from scipy.linalg.lapack import dtbtrs

    bands = np.repeat(np.asarray(poles)[:, None], x.shape[-1], axis=1)
    y, _ = dtbtrs(bands, x.reshape(-1, x.shape[-1]).T, uplo="L", diag="U")
    return np.asarray(y.T.reshape(x.shape))


def sliding_minimum(x: Array, width: int) -> Array:
    """Least of the ``width`` samples around each, an odd number; fewer at the ends. Shape (n,).

    >>> sliding_minimum(np.array([3.0, 1.0, 2.0, 4.0]), 3)
    array([1., 1., 1., 2.])
    """
    beyond = np.full(width // 2, np.inf)
    least, size = np.concatenate([beyond, x, beyond]), 1
    while 2 * size <= width:
        least, size = np.minimum(least[:-size], least[size:]), 2 * size
    return np.asarray(np.minimum(least[: x.size], least[width - size :][: x.size]))


def since(time: Array, event: Mask) -> Array:
    """Time since the ``event`` last held [s] (n,); infinite before its first.

    >>> since(np.array([0.0, 1.0, 2.0]), np.array([False, True, False]))
    array([inf,  0.,  1.])
    """
    return np.asarray(time - np.maximum.accumulate(np.where(event, time, -np.inf)))


def without_single(x: Array) -> Array:
    """Median of each value (n,) and its neighbours; deep slip lasts 50 ms, an error one sample.

    >>> without_single(np.array([3.0, 3.0, 0.0, 3.0, 2.0, 1.0]))
    array([3., 3., 3., 2., 2., 1.])
    """
    previous, middle, following = x[:-2], x[1:-1], x[2:]
    low, high = np.minimum(previous, middle), np.maximum(previous, middle)
    return np.concatenate([x[:1], np.maximum(low, np.minimum(high, following)), x[-1:]])


def runs(mask: Mask, least: int = 1) -> list[tuple[int, int]]:
    """Start and end (exclusive) of each run of at least ``least`` samples with a true ``mask``.

    >>> runs(np.array([False, True, True, False, True]))
    [(1, 3), (4, 5)]
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    first, last = edges[::2], edges[1::2]
    long = last - first >= least
    return list(zip(first[long].tolist(), last[long].tolist(), strict=True))


def products_of(columns: Array, y: Array) -> tuple[Array, Array, Array]:
    """Products of ``columns`` (m, k, n) with each other, with ``y`` (n,), and of y with itself."""
    return columns @ np.swapaxes(columns, 1, 2), columns @ y, y @ y


def left_of(products: tuple[Array, Array, Array], ridge: Array | float = 0.0) -> Array:
    """Residual sums of squares (m,) of least squares of y on the columns, from `products_of`.

    ``ridge`` (k,) penalises the squared coefficients. A zero or repeated column changes nothing.
    Accurate to 1e-9 of the squares of y.
    """
    gram, side, square = products
    gram = gram + ridge * np.eye(gram.shape[1])
    size = np.sqrt(np.diagonal(gram, axis1=1, axis2=2))
    size = np.where(size > 0.0, size, 1.0)
    side = side / size
    gram = gram / (size[:, :, None] * size[:, None, :]) + 1e-9 * np.eye(size.shape[1])
    shares = np.linalg.solve(gram, side[..., None])[..., 0]
    return np.asarray(np.maximum(square - np.sum(side * shares, axis=1), 0.0))


def lasting_variance(x: Array, size: int) -> float:
    """Variance of a residual (n,) as white noise, by its means over ``size`` if that is larger.

    So correlated errors count; at least four means are needed for that.
    """
    short = float(np.mean(x**2))
    if x.size < 4 * size:
        return short
    return max(short, size * float(np.var(block_mean(x, size))))

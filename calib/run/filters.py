"""Numerics of sampled signals: means, causal filters, intervals of a mask, many regressions."""

from collections.abc import Sequence
from functools import lru_cache

import numpy as np

from calib.base.arrays import Array, Index, Mask


def samples_in(time: float, step: float) -> int:
    """Number of samples in a ``time`` [s] at a sample time ``step`` [s], at least one."""
    return max(1, round(time / step))


def block_mean(x: Array, size: int) -> Array:
    """Means over blocks of ``size`` samples along the last axis; a shorter rest is left out."""
    count = x.shape[-1] // size
    blocks = x[..., : count * size].reshape(*x.shape[:-1], count, size)
    return np.asarray(blocks @ np.ones(size) / size)  # eight times as fast as a mean of short rows


class GroupMean:
    """Means over groups of samples; each group is given by the indices of its samples.

    >>> GroupMean([np.array([0, 1]), np.array([3])])(np.array([1.0, 3.0, 5.0, 7.0]))
    array([2., 7.])
    """

    def __init__(self, groups: Sequence[Index]) -> None:
        self.sizes = np.array([group.size for group in groups])
        self._samples = np.concatenate(groups)
        self._starts = np.cumsum(self.sizes) - self.sizes

    def __call__(self, x: Array) -> Array:
        """Mean of ``x`` (..., n) over each of the g groups, (..., g)."""
        values = x.take(self._samples, axis=-1)
        return np.asarray(np.add.reduceat(values, self._starts, axis=-1) / self.sizes)


def trailing_mean(x: Array, width: int) -> Array:
    """Mean of the last ``width`` samples, of fewer at the start. Shape (n,)."""
    total = np.cumsum(np.concatenate([[0.0], x]))
    stop = np.arange(1, x.size + 1)
    start = np.maximum(stop - width, 0)
    return np.asarray((total[stop] - total[start]) / (stop - start))


def centred_mean(x: Array, width: int, *, held_ends: bool = False) -> Array:
    """Mean of the ``width`` samples around each sample. Shape (n,).

    An even width has one sample more before than after. At both ends of the signal the mean is
    over fewer samples; with ``held_ends`` the first and last sample are repeated instead.

    >>> x = np.array([0.0, 3.0, 6.0])
    >>> centred_mean(x, 3).tolist(), centred_mean(x, 3, held_ends=True).tolist()
    ([1.5, 3.0, 4.5], [1.0, 3.0, 5.0])
    """
    if held_ends:
        margin = width // 2
        padded = np.pad(x, (margin, width - 1 - margin), "edge")
        total = np.cumsum(np.concatenate([[0.0], padded]))
        return np.asarray((total[width:] - total[:-width]) / width)
    start, stop, count = _window(x.size, width)
    total = np.concatenate([[0.0], np.cumsum(x)])
    return np.asarray((total[stop] - total[start]) / count)


@lru_cache(maxsize=8)
def _window(size: int, width: int) -> tuple[Index, Index, Array]:
    """Start, end (exclusive) and number of the samples around each of ``size`` samples; cached."""
    first = np.arange(size) - width // 2
    start, stop = np.maximum(first, 0), np.minimum(first + width, size)
    return start, stop, (stop - start).astype(np.float64)


def low_pass(x: Array, step: float, time_constant: float) -> Array:
    """First-order causal low-pass of ``x`` (n,), which is constant between samples; times in s."""
    gain = 1.0 - float(np.exp(-step / time_constant))
    return recursive_filter(np.append(x[:1], gain * x[1:]), [1.0, gain - 1.0])


def recursive_filter(x: Array, poles: Sequence[float] | Array) -> Array:
    """Output y of y[k] + poles[1] y[k-1] + poles[2] y[k-2] + ... = x[k], from rest, (..., n).

    It is solved as a banded system, since `scipy.signal` takes long to import.

    >>> recursive_filter(np.array([1.0, 0.0, 0.0]), [1.0, -0.5])
    array([1.  , 0.5 , 0.25])
    """
    from scipy.linalg.lapack import dtbtrs

    bands = np.repeat(np.asarray(poles)[:, None], x.shape[-1], axis=1)
    y, _ = dtbtrs(bands, x.reshape(-1, x.shape[-1]).T, uplo="L", diag="U")
    return np.asarray(y.T.reshape(x.shape))


def median_of_three(x: Array) -> Array:
    """Median of each value (n,) and its two neighbours; it removes an error of a single sample.

    >>> median_of_three(np.array([3.0, 3.0, 0.0, 3.0, 2.0, 1.0]))
    array([3., 3., 3., 2., 2., 1.])
    """
    previous, middle, following = x[:-2], x[1:-1], x[2:]
    low, high = np.minimum(previous, middle), np.maximum(previous, middle)
    return np.concatenate([x[:1], np.maximum(low, np.minimum(high, following)), x[-1:]])


def time_since(time: Array, event: Mask) -> Array:
    """Time since the ``event`` was last true [s] (n,); infinite before it was first true.

    >>> time_since(np.array([0.0, 1.0, 2.0]), np.array([False, True, False]))
    array([inf,  0.,  1.])
    """
    return np.asarray(time - np.maximum.accumulate(np.where(event, time, -np.inf)))


def true_intervals(mask: Mask) -> list[tuple[int, int]]:
    """Start and end (exclusive) of each interval of samples in which ``mask`` is true.

    >>> true_intervals(np.array([False, True, True, False, True]))
    [(1, 3), (4, 5)]
    """
    edges = np.flatnonzero(np.diff(np.concatenate([[False], mask, [False]]).astype(np.int8)))
    return list(zip(edges[::2].tolist(), edges[1::2].tolist(), strict=True))


def inner_products(columns: Array, y: Array) -> tuple[Array, Array, Array]:
    """Return A^T A (m, k, k), A^T y (m, k), y^T y of m regressions; ``columns`` A^T (m, k, n)."""
    return columns @ np.swapaxes(columns, 1, 2), columns @ y, y @ y


def residual_squares(products: tuple[Array, Array, Array], ridge: Array | float = 0.0) -> Array:
    """Residual sums of squares (m,) from the ``products`` of `inner_products`.

    Regressions of different y have y^T y of shape (m,). ``ridge`` (k,) penalises squared
    coefficients. A zero or repeated column changes nothing. The result is exact to 1e-9 of y^T y.
    """
    gram, right_side, square = products
    identity = np.eye(gram.shape[1])
    gram = gram + ridge * identity
    norm = np.sqrt(np.diagonal(gram, axis1=1, axis2=2))  # of each column, (m, k)
    norm = np.where(norm > 0.0, norm, 1.0)
    right_side = right_side / norm
    gram = gram / (norm[:, :, None] * norm[:, None, :]) + 1e-9 * identity
    coefficients = np.linalg.solve(gram, right_side[..., None])[..., 0]
    return np.asarray(np.maximum(square - np.sum(right_side * coefficients, axis=1), 0.0))


def long_run_variance(x: Array, size: int) -> float:
    """Variance of the white noise whose long means scatter as those of a residual ``x`` (n,).

    It is the variance of ``x``, or ``size`` times that of its means over ``size`` samples if that
    is larger. With fewer than four such means the residual is taken as white.
    """
    variance = float(np.mean(x**2))
    if x.size < 4 * size:
        return variance
    return max(variance, size * float(np.var(block_mean(x, size))))

"""What least squares leave, of many fits at a time, and how long it lasts."""

import numpy as np

from calib.base.arrays import Array
from calib.run.filters import block_mean

_SURE = 1e-4  # least over largest pivot from which normal equations are good to 1e-8 [1]


def square_left(A: Array, y: Array) -> float:
    """Least sum of squares of ``y`` (n,) less a mix of the columns of one ``A`` (n, k)."""
    from scipy.linalg.lapack import dposv

    side = A.T @ y
    root, shares, failed = dposv(A.T @ A, side)
    pivots = np.diagonal(root)
    if failed or pivots.min() < _SURE * pivots.max():  # columns that are nearly alike
        left = y - A @ np.linalg.lstsq(A, y, rcond=None)[0]
        return float(left @ left)
    return float(y @ y - side @ shares)


def squares_left(columns: Array, y: Array, ridge: Array | float = 0.0) -> Array:
    """Least sums of squares of ``y`` (m, n) or (n,) less a mix of ``columns`` (m, k, n), (m,).

    ``ridge`` (k,) times the square of each share is added. A column that is zero, or the same as
    another, adds nothing. Right to 1e-9 of the squares of y.
    """
    return left_of(products_of(columns, y), ridge)


def products_of(columns: Array, y: Array) -> tuple[Array, Array, Array]:
    """Products of ``columns`` with each other (m, k, k), with ``y`` (m, k), and of y (m,)."""
    gram, side = columns @ np.swapaxes(columns, 1, 2), (columns @ y[..., None])[..., 0]
    return gram, side, np.sum(y**2, axis=-1)


def left_of(products: tuple[Array, Array, Array], ridge: Array | float = 0.0) -> Array:
    """As `squares_left`, of what `products_of` gives."""
    gram, side, square = products
    gram = gram + ridge * np.eye(gram.shape[1])
    size = np.sqrt(np.diagonal(gram, axis1=1, axis2=2))
    size = np.where(size > 0.0, size, 1.0)
    side = side / size
    gram = gram / (size[:, :, None] * size[:, None, :]) + 1e-9 * np.eye(size.shape[1])
    shares = np.linalg.solve(gram, side[..., None])[..., 0]
    return np.asarray(np.maximum(square - np.sum(side * shares, axis=1), 0.0))


def lasting_variance(x: Array, size: int) -> float:
    """Variance of a residual (n,) as if it were white, by its means over ``size`` samples, too.

    It counts how long an error lasts; at least four means are needed for that.
    """
    short = float(np.mean(x**2))
    if x.size < 4 * size:
        return short
    return max(short, size * float(np.var(block_mean(x, size))))

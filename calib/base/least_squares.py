"""How much of a signal others explain, by linear least squares."""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


def explained_square(columns: Array, y: Array) -> Array:
    """Sum of squares of ``y`` (n,) that the ``columns`` (..., k, n) explain, (...).

    By the normal equations b' (A'A)^-1 b with b = A'y, for all sets of columns at once; columns of
    unit size. A column that is zero, or the same as another, adds nothing. Not for columns that are
    alike to 1e-6.

    >>> columns = np.array([[1.0, 1.0, 0.0], [0.0, 0.0, 0.0]])
    >>> round(float(explained_square(columns, np.array([2.0, 4.0, 5.0]))), 9)
    18.0
    """
    sizes = np.linalg.norm(columns, axis=-1, keepdims=True)
    A = columns / np.where(sizes > 0.0, sizes, 1.0)
    b = A @ y
    inverse = np.linalg.pinv(A @ np.swapaxes(A, -1, -2), rcond=1e-12, hermitian=True)
    return np.asarray(np.einsum("...i,...ij,...j->...", b, inverse, b))

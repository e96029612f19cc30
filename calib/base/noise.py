"""Noise: its size, the moving average of differences, and how much of a signal others explain."""

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import QUARTILE


def second_differences(white: float, walk: float, turned: float) -> tuple[Array, float]:
    """The moving average (3,) and sigma of second differences of v against the integral of a_x.

    ``white`` variance of v, ``walk`` of a step of the integral, ``turned`` of a change of its step,
    as by a slope that wanders [m^2/s^2].
    """
    covariance = [6.0 * white + 2.0 * walk + turned, -4.0 * white - walk, white]
    return moving_average(np.array(covariance))


def moving_average(covariance: Array) -> tuple[Array, float]:
    """Coefficients (q + 1,), the first is 1, and sigma of a moving average that can be undone.

    From its ``covariance`` (q + 1,) at the distances 0 to q. Its spectrum is a polynomial whose
    roots come in pairs z, 1/z: those within the unit circle are taken (Brockwell and Davis, Time
    Series: Theory and Methods, section 3.1).
    """
    roots = np.roots(np.concatenate([covariance[:0:-1], covariance]))
    inside = sorted(roots, key=abs)[: covariance.size - 1]
    average = np.real(np.poly(inside))
    return average, float(np.sqrt(covariance[-1] / average[-1]))


def noise_of(x: Array) -> float:
    """Standard deviation of white noise on a smooth x (n,), by the median second difference."""
    return float(np.median(np.abs(np.diff(x, 2))) / QUARTILE / np.sqrt(6.0))


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

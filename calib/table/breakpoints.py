"""Breakpoints: the rows of a table that are kept, with the least error of linear interpolation.

The whole table is linear between its rows, so the largest error of the reduced table is at a
dropped row. Dynamic programming finds the global optimum: the least maximum error, and among equal
maxima the least sum of squares (Bellman and Roth, J. Amer. Stat. Assoc. 64, 1969). The time grows
with the cube of the number of rows: use some hundred at most.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from calib.base.arrays import Array, Index

FEWEST = 2  # breakpoints of an axis: its two ends


@dataclass(frozen=True)
class Misfit:
    """Errors of a reduced table: the largest error, its place, and the largest rms of a curve."""

    worst: float
    worst_at: float
    rms: float


def place(x: Array, curves: Array, points: int) -> Index:
    """Return the rows of ``x`` (n,) to keep for ``curves`` (k, n), which have one unit.

    These are ``points`` rows, at least 2, with both ends, or fewer if more would not help.
    """
    n = len(x)
    if points >= n:
        return np.arange(n)
    worst, square = _segments(x, curves)
    least_worst, _ = _least(worst, points, np.maximum)
    worst_by_count = least_worst[:, n - 1]  # up to the last row
    least = worst_by_count[FEWEST:].min()
    # of equal errors take the most points: for usual curves that is ``points``
    count = int(np.flatnonzero(worst_by_count == least)[-1])
    _, previous = _least(np.where(worst <= least, square, np.inf), count, np.add)
    return _path(previous, count, n)


def place_weighted(x: Array, curves: Array, weights: Array, points: int) -> Index:
    """Return the rows of ``x`` (n,) as in `place`, by the least weighted sum of squared errors.

    ``curves`` and ``weights`` (k, n) are slices of a map; corners of small weight get few points.
    """
    n = len(x)
    if points >= n:
        return np.arange(n)
    square = np.full((n, n), np.inf)
    for i, j, gaps in _lines(x, curves):
        square[i, j] = np.sum(weights[:, i : j + 1] * gaps**2)
    least, previous = _least(square, points, np.add)
    return _path(previous, FEWEST + int(np.argmin(least[FEWEST:, n - 1])), n)


def misfit(x: Array, curves: Array, points: Array, values: Array) -> Misfit:
    """Exact errors of ``values`` (k, m) at ``points`` (m,) against ``curves`` (k, n) over ``x``.

    Values and curves are linear between points, and constant beyond the ends.
    """
    places = np.union1d(x, points)
    pairs = zip(values, curves, strict=True)
    gaps = np.array([np.interp(places, points, v) - np.interp(places, x, y) for v, y in pairs])
    k, i = np.unravel_index(int(np.argmax(np.abs(gaps))), gaps.shape)
    squares = [_integral_of_square(places, gap) for gap in gaps]
    rms = float(np.sqrt(max(squares) / (places[-1] - places[0])))
    return Misfit(float(abs(gaps[k, i])), float(places[i]), rms)


def _integral_of_square(x: Array, gap: Array) -> float:
    """Integral of the square of a ``gap`` that is linear between the points ``x``."""
    a, b = gap[:-1], gap[1:]
    return float(np.sum(np.diff(x) * (a * a + a * b + b * b)) / 3.0)


def _segments(x: Array, curves: Array) -> tuple[Array, Array]:
    """Largest error and integral of squared errors of a line from row i to row j > i, (n, n)."""
    n = len(x)
    worst, square = np.full((n, n), np.inf), np.full((n, n), np.inf)
    for i, j, gaps in _lines(x, curves):
        gaps[:, 0] = gaps[:, -1] = 0.0  # without rounding errors
        worst[i, j] = np.abs(gaps).max()
        square[i, j] = sum(_integral_of_square(x[i : j + 1], gap) for gap in gaps)
    return worst, square


def _lines(x: Array, curves: Array) -> Iterator[tuple[int, int, Array]]:
    """Yield all rows i < j, and the gaps (k, j - i + 1) of the curves to lines from i to j."""
    for i, j in combinations(range(len(x)), 2):
        share = (x[i : j + 1] - x[i]) / (x[j] - x[i])
        line = curves[:, i, None] + share * (curves[:, j] - curves[:, i])[:, None]
        yield i, j, curves[:, i : j + 1] - line


def _least(cost: Array, points: int, join: np.ufunc) -> tuple[Array, Index]:
    """Return the least cost of p breakpoints of which the last is row j, and the one before j.

    Both are (points + 1, n), indexed by p and j. ``cost`` (n, n) is that of a line from row i to
    row j; ``join`` joins the costs of successive lines.
    """
    n = len(cost)
    least = np.full((points + 1, n), np.inf)
    previous = np.zeros((points + 1, n), dtype=np.intp)
    least[1, 0] = 0.0
    for p in range(FEWEST, points + 1):
        total = join(least[p - 1][:, None], cost)  # (n, n)
        previous[p] = np.argmin(total, axis=0)
        least[p] = total[previous[p], np.arange(n)]
    return least, previous


def _path(previous: Index, points: int, n: int) -> Index:
    """Follow ``previous`` back from the last row; return the ``points`` rows in rising order."""
    rows = [n - 1]
    for p in range(points, 1, -1):
        rows.append(int(previous[p, rows[-1]]))
    return np.array(rows[::-1], dtype=np.intp)

"""Breakpoints: the rows of a table to keep for the least error of linear interpolation.

The table is linear between its rows, so the largest error is exact, at a dropped row. Dynamic
programming finds the global optimum: the least maximum error, and among equal ones the least sum of
squares (Bellman and Roth, J. Amer. Stat. Assoc. 64, 1969). The time grows with the cube of the
rows: meant for some hundred.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import combinations

import numpy as np

from calib.base.arrays import Array, Index

FEWEST = 2
"""Least number of breakpoints of an axis: its ends."""


@dataclass(frozen=True)
class Misfit:
    """Largest error ``worst`` between breakpoints, where it is, and the largest ``rms``."""

    worst: float
    worst_at: float
    rms: float


def place(x: Array, curves: Array, points: int) -> Index:
    """Rows of ``x`` (n,) to keep, with both ends, for ``curves`` (k, n) in one unit.

    ``points`` of them, at least 2; fewer where more would increase the error.
    """
    n = len(x)
    if points >= n:
        return np.arange(n)
    worst, square = _segments(x, curves)
    reach = _least(worst, points, np.maximum)[0][:, n - 1]
    least = reach[FEWEST:].min()
    # of equal errors take the most points: for usual curves that is ``points``
    count = int(np.flatnonzero(reach == least)[-1])
    _, back = _least(np.where(worst <= least, square, np.inf), count, np.add)
    return _path(back, count, n)


def place_weighted(x: Array, curves: Array, weights: Array, points: int) -> Index:
    """Rows of ``x`` (n,) as in `place`, by the least weighted sum of _squared errors.

    ``curves`` (k, n) are slices of a map, ``weights`` (k, n) those of its cells, so that corners
    that few draws reach do not take all breakpoints.
    """
    n = len(x)
    if points >= n:
        return np.arange(n)
    square = np.full((n, n), np.inf)
    for i, j, gaps in _lines(x, curves):
        square[i, j] = np.sum(weights[:, i : j + 1] * gaps**2)
    reach, back = _least(square, points, np.add)
    return _path(back, FEWEST + int(np.argmin(reach[FEWEST:, n - 1])), n)


def misfit(x: Array, curves: Array, points: Array, values: Array) -> Misfit:
    """Error of ``values`` (k, m) at ``points`` (m,) against ``curves`` (k, n) over ``x`` (n,).

    Exact, since both are piecewise linear; each is constant beyond its ends.
    """
    every = np.union1d(x, points)
    gaps = np.array(
        [
            np.interp(every, points, v) - np.interp(every, x, y)
            for v, y in zip(values, curves, strict=True)
        ]
    )
    k, i = np.unravel_index(int(np.argmax(np.abs(gaps))), gaps.shape)
    squares = [_squared(every, gap) for gap in gaps]
    rms = float(np.sqrt(max(squares) / (every[-1] - every[0])))
    return Misfit(float(abs(gaps[k, i])), float(every[i]), rms)


def _squared(x: Array, gap: Array) -> float:
    """Integral of the square of a ``gap`` that is linear between the points ``x``."""
    a, b = gap[:-1], gap[1:]
    return float(np.sum(np.diff(x) * (a * a + a * b + b * b)) / 3.0)


def _segments(x: Array, curves: Array) -> tuple[Array, Array]:
    """Largest error and integral of the _squared error of a line from row i to row j, (n, n)."""
    n = len(x)
    worst, square = np.full((n, n), np.inf), np.full((n, n), np.inf)
    for i, j, gaps in _lines(x, curves):
        gaps[:, 0] = gaps[:, -1] = 0.0
        worst[i, j] = np.abs(gaps).max()
        square[i, j] = sum(_squared(x[i : j + 1], gap) for gap in gaps)
    return worst, square


def _lines(x: Array, curves: Array) -> Iterator[tuple[int, int, Array]]:
    """Two rows i < j, and the distance (k, j - i + 1) of the curves from a line between them."""
    for i, j in combinations(range(len(x)), 2):
        share = (x[i : j + 1] - x[i]) / (x[j] - x[i])
        line = curves[:, i, None] + share * (curves[:, j] - curves[:, i])[:, None]
        yield i, j, curves[:, i : j + 1] - line


def _least(cost: Array, points: int, join: np.ufunc) -> tuple[Array, Index]:
    """Least cost of p points that end at row j, (points + 1, n), and the row before j."""
    n = len(cost)
    reach = np.full((points + 1, n), np.inf)
    back = np.zeros((points + 1, n), dtype=np.intp)
    reach[1, 0] = 0.0
    for p in range(FEWEST, points + 1):
        total = join(reach[p - 1][:, None], cost)
        back[p] = np.argmin(total, axis=0)
        reach[p] = total[back[p], np.arange(n)]
    return reach, back


def _path(back: Index, points: int, n: int) -> Index:
    row, rows = n - 1, [n - 1]
    for p in range(points, 1, -1):
        row = int(back[p, row])
        rows.append(row)
    return np.array(rows[::-1], dtype=np.intp)

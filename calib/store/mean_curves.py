"""The mean curves of several cars on their common axes, with the scatter between the cars.

    D(eta)   1 to where the shortest table ends;  D(1) = 0 in every car, so in the mean
    f1, f2   from the mean D at the load split of the mean z(eta): (18) holds in every row
    g(slip)  0 to where the shortest ends

A band is that of the table of one more car: scatter between cars, error of the mean, noise of one
run, and what all cars share. All but the last go with Student's t of one degree of freedom less
than there are cars.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calib.base.intervals import Z95
from calib.base.random_effects import RandomEffects, quantile95, random_effects
from calib.car.forces import paper_curves
from calib.store.own_errors import own_share, own_share_of_tyre
from calib.table.table import DifferenceCurve, PaperCurves, Table, TyreCurve

Array = NDArray[np.float64]


class OneCurve(NamedTuple):
    """One curve of all k cars on a common axis (n,): ``values``, ``own`` and ``shared`` (k, n).

    ``own`` and ``shared`` variances, see `calib.store.own_errors`.
    """

    axis: Array
    values: Array
    own: Array
    shared: Array


def all_D(tables: Sequence[Table]) -> OneCurve:
    """D of all cars, from eta = 1 to the end of the shortest table."""
    curves = [t.difference for t in tables]
    eta = _common(1.0, [c.eta for c in curves])
    bands = [(c.eta, c.D, c.upper - c.lower) for c in curves]
    return _curve(eta, bands, [own_share(t, eta) for t in tables])


def all_g(tables: Sequence[Table]) -> OneCurve:
    """The tyre curve of all cars, from no slip to the end of the shortest table."""
    curves = [t.tyre for t in tables]
    slip = _common(0.0, [c.slip for c in curves])
    bands = [(c.slip, c.force, c.upper - c.lower) for c in curves]
    return _curve(slip, bands, [own_share_of_tyre(t, slip) for t in tables])


def car_weights(of: OneCurve) -> Array:
    """Weight of each car (k,), by how well its D is known where D is largest.

    A car has one weight in the whole mean: what belongs together in a car stays together.
    """
    top = int(np.argmax(np.abs(of.values.mean(axis=0))))
    at = slice(top, top + 1)
    return np.asarray(random_effects(of.values[:, at], of.own[:, at]).weights[:, 0])


def mean_difference(
    tables: Sequence[Table], of: OneCurve, weights: Array
) -> tuple[DifferenceCurve, RandomEffects]:
    """The mean D(eta), and its scatter."""
    found = random_effects(of.values, of.own, weights)
    half = half_width(found, of.shared, weights)
    curves = [t.difference for t in tables]
    count, flag = _cells(of.axis, [(c.eta, c.count, c.flag) for c in curves])
    D = found.mean
    return DifferenceCurve(of.axis, D, D - half, D + half, count, flag), found


def mean_paper(tables: Sequence[Table], d: DifferenceCurve, weights: Array) -> PaperCurves:
    """f1 and f2 from the mean ``d``."""
    vehicle = tables[0].vehicle
    z = np.asarray(weights @ [np.interp(d.eta, t.paper.eta, t.paper.z) for t in tables])
    f1, f2 = paper_curves(vehicle, z, d.D)
    f1_a, f2_a = paper_curves(vehicle, z, d.lower)
    f1_b, f2_b = paper_curves(vehicle, z, d.upper)
    return PaperCurves(d.eta, z, f1, f1_a, f1_b, f2, f2_b, f2_a, d.count, d.flag)


def mean_tyre(tables: Sequence[Table], weights: Array) -> TyreCurve:
    """The mean g(slip)."""
    of = all_g(tables)
    found = random_effects(of.values, of.own, weights)
    half = half_width(found, of.shared, weights)
    curves = [t.tyre for t in tables]
    count, flag = _cells(of.axis, [(c.slip, c.count, c.flag) for c in curves])
    g = found.mean
    return TyreCurve(of.axis, g, g - half, g + half, count, flag)


def half_width(found: RandomEffects, shared: Array, weights: Array) -> Array:
    """Half width of the 95 % band of one more car; ``shared`` variances (k, n)."""
    of_cars = quantile95(found.freedom) * found.one_more
    return np.asarray(np.hypot(of_cars, Z95 * np.sqrt(weights @ shared)))


def _common(start: float, axes: list[Array]) -> Array:
    return np.linspace(start, min(float(a[-1]) for a in axes), max(a.size for a in axes))


def _curve(axis: Array, bands: list[tuple[Array, Array, Array]], share: list[Array]) -> OneCurve:
    values = np.array([np.interp(axis, x, y) for x, y, _ in bands])
    variance = np.array([(np.interp(axis, x, w) / (2.0 * Z95)) ** 2 for x, _, w in bands])
    own = variance * np.array(share)
    return OneCurve(axis, values, own, variance - own)


def _cells(axis: Array, cells: list[tuple[Array, Array, Array]]) -> tuple[Array, Array]:
    """Blocks of all cars in each cell, and the flag of the middle car, of the worse of two."""
    nearest = [np.abs(x[:, None] - axis).argmin(axis=0) for x, _, _ in cells]
    counts = [count[at] for (_, count, _), at in zip(cells, nearest, strict=True)]
    flags = [flag[at] for (_, _, flag), at in zip(cells, nearest, strict=True)]
    return np.sum(counts, axis=0), np.sort(flags, axis=0)[len(cells) // 2]

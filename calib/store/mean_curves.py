"""The mean curves of several cars on their common axes, with the scatter between the cars.

    D(eta)   1 to where the shortest table ends;  D(1) = 0 in every car, so in the mean
    f1, f2   from the mean D at the load split of the mean z(eta): (18) holds in every row
    g(slip)  0 to where the shortest ends

A band is that of the table of one more car: scatter between cars, error of the mean, noise of one
run, and what all cars share. All but the last go with Student's t of one degree of freedom less
than there are cars.
"""

from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

from calib.base.intervals import Z95
from calib.base.random_effects import RandomEffects, quantile95, random_effects
from calib.car.forces import paper_curves
from calib.store.own_errors import own_share, own_share_of_tyre
from calib.table.table import Array, DifferenceCurve, PaperCurves, Table, TyreCurve


class MeanCurves(NamedTuple):
    """The curves of a mean table, the scatter of D, and the weight of each car (k,)."""

    difference: DifferenceCurve
    paper: PaperCurves
    tyre: TyreCurve
    scatter: RandomEffects
    weights: Array


class _OneCurve(NamedTuple):
    """One curve of all k cars on a common axis (n,): values and variances (k, n)."""

    axis: Array
    values: Array
    own: Array
    shared: Array
    blocks: Array
    flag: Array


def mean_curves(tables: Sequence[Table]) -> MeanCurves:
    """The mean curves.

    A car has one weight in the whole mean, by how well its D is known where D is largest: what
    belongs together in a car stays together.
    """
    d = [t.difference for t in tables]
    of_D = _on_one_axis(
        1.0,
        [(c.eta, c.D, c.upper - c.lower, c.count, c.flag) for c in d],
        lambda eta: [own_share(t, eta) for t in tables],
    )
    top = int(np.argmax(np.abs(of_D.values.mean(axis=0))))
    at = slice(top, top + 1)
    weights = np.asarray(random_effects(of_D.values[:, at], of_D.own[:, at]).weights[:, 0])
    g = [t.tyre for t in tables]
    of_g = _on_one_axis(
        0.0,
        [(c.slip, c.force, c.upper - c.lower, c.count, c.flag) for c in g],
        lambda slip: [own_share_of_tyre(t, slip) for t in tables],
    )
    scatter, columns = _mean(of_D, weights)
    difference = DifferenceCurve(*columns)
    tyre = TyreCurve(*_mean(of_g, weights)[1])
    return MeanCurves(difference, _paper(tables, difference, weights), tyre, scatter, weights)


def _paper(tables: Sequence[Table], d: DifferenceCurve, weights: Array) -> PaperCurves:
    """f1 and f2 from the mean ``d``."""
    vehicle = tables[0].vehicle
    z = np.asarray(weights @ [np.interp(d.eta, t.paper.eta, t.paper.z) for t in tables])
    f1, f2 = paper_curves(vehicle, z, d.D)
    f1_a, f2_a = paper_curves(vehicle, z, d.lower)
    f1_b, f2_b = paper_curves(vehicle, z, d.upper)
    return PaperCurves(d.eta, z, f1, f1_a, f1_b, f2, f2_b, f2_a, d.count, d.flag)


def _mean(of: _OneCurve, weights: Array) -> tuple[RandomEffects, tuple[Array, ...]]:
    """Scatter, and the columns: axis, mean, the band of one more car, blocks, flags."""
    found = random_effects(of.values, of.own, weights)
    of_cars = quantile95(found.freedom) * found.one_more
    half = np.asarray(np.hypot(of_cars, Z95 * np.sqrt(weights @ of.shared)))
    mean = found.mean
    return found, (of.axis, mean, mean - half, mean + half, of.blocks, of.flag)


def _on_one_axis(
    start: float, curves: Sequence[tuple[Array, ...]], own_shares: Callable[[Array], list[Array]]
) -> _OneCurve:
    """Axis, value, width of the band, blocks and flags of each car, from ``start`` to the shortest.

    A cell has the blocks of all cars, and the flag of the middle car, of the worse of two.
    """
    axes = [curve[0] for curve in curves]
    axis = np.linspace(start, min(float(a[-1]) for a in axes), max(a.size for a in axes))
    values = np.array([np.interp(axis, x, y) for x, y, *_ in curves])
    variance = np.array([(np.interp(axis, x, w) / (2.0 * Z95)) ** 2 for x, _, w, *_ in curves])
    own = variance * np.array(own_shares(axis))
    nearest = [np.abs(x[:, None] - axis).argmin(axis=0) for x in axes]
    counts, flags = (
        np.array([curve[column][at] for curve, at in zip(curves, nearest, strict=True)])
        for column in (3, 4)
    )
    middle = np.sort(flags, axis=0)[len(curves) // 2]
    return _OneCurve(axis, values, own, variance - own, counts.sum(axis=0), middle)

"""The mean of several cars: curves on common axes, pads, tyre and budget, all of one more car.

    D(eta)   1 to where the shortest table ends;  D(1) = 0 in every car, so in the mean
    f1, f2   from the mean D at the load split of the mean z(eta): (18) holds in every row
    g(slip)  0 to where the shortest ends

A band is that of the table of one more car: scatter between cars, error of the mean, noise of one
run, and what all cars share. All but the last go with Student's t of one degree of freedom less
than there are cars. In the budget they are the part `cars`; the other parts are as large as in one
car: a mean does not make them smaller.

    own      noise, zeros              another run of the same car draws them anew
    shared   mass, resistance,         vehicle file, track, kind of sensor, method: alike in all
             accelerometer, tyres,     cars of a line, so that a mean of cars keeps them
             load_geometry, unlike_pads

What of the shared ones is not alike (a driver's weight, one car's accelerometer) is seen as spread
between cars. A table without a budget does not say what is its own; nothing of it is then.
"""

from collections.abc import Callable, Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from calib.base.intervals import Z95
from calib.base.random_effects import RandomEffects, quantile95, random_effects
from calib.fitting.curves import as_cubic, differences, paper_of, ridge, tyre_forces
from calib.fitting.ensemble import Ensemble, Shown, ensemble_of
from calib.fitting.pads import calibration_of
from calib.model.settings import SETTINGS
from calib.table.budget import budget_of
from calib.table.pad_levels import PadLevels, pad_levels, pad_scale
from calib.table.table import (
    Array,
    DifferenceCurve,
    Table,
    TyreCurve,
    TyrePosterior,
    Value,
)

_CARS = "cars"
"""Part of a budget that is the difference between cars."""


_OWN = ("noise", "zeros")
"""Parts of `calib.table.budget` that differ from run to run and cannot be alike in two cars."""

RATIO, COMPLIANCE = "log_pad_ratio", "log_compliance"


class _OneCurve(NamedTuple):
    """One curve of all k cars on a common axis (n,): values and variances (k, n)."""

    axis: Array
    values: Array
    own: Array
    shared: Array
    blocks: Array
    flag: Array


def mean_curves(tables: Sequence[Table]) -> tuple[dict[str, Any], RandomEffects, Array]:
    """The curves of a mean table by name, the scatter of D, and the weight of each car (k,).

    A car has one weight in the whole mean, by how well its D is known where D is largest: what
    belongs together in a car stays together.
    """
    d, g = ([[*vars(getattr(t, of)).values()] for t in tables] for of in ("difference", "tyre"))
    of_D = _on_one_axis(1.0, d, lambda eta: [own_share(t, eta) for t in tables])
    top = int(np.argmax(np.abs(of_D.values.mean(axis=0))))
    at = slice(top, top + 1)
    weights = np.asarray(random_effects(of_D.values[:, at], of_D.own[:, at]).weights[:, 0])
    of_g = _on_one_axis(0.0, g, lambda slip: [own_share_of_tyre(t, slip) for t in tables])
    scatter, columns = _mean(of_D, weights)
    difference, tyre = DifferenceCurve(*columns), TyreCurve(*_mean(of_g, weights)[1])
    z = np.asarray(weights @ [np.interp(of_D.axis, t.paper.eta, t.paper.z) for t in tables])
    paper = paper_of(tables[0].vehicle, difference, z)
    return {"difference": difference, "paper": paper, "tyre": tyre}, scatter, weights


def _mean(of: _OneCurve, weights: Array) -> tuple[RandomEffects, tuple[Array, ...]]:
    """Scatter, and the columns: axis, mean, the band of one more car, blocks, flags."""
    found = random_effects(of.values, of.own, weights)
    of_cars = quantile95(found.freedom) * found.one_more
    half = np.asarray(np.hypot(of_cars, Z95 * np.sqrt(weights @ of.shared)))
    mean = found.mean
    return found, (of.axis, mean, mean - half, mean + half, of.blocks, of.flag)


def _on_one_axis(
    start: float, curves: Sequence[Sequence[Array]], own_shares: Callable[[Array], list[Array]]
) -> _OneCurve:
    """The columns of one curve of each car on a common axis, from ``start`` to the shortest.

    A cell has the blocks of all cars, and the flag of the middle car, of the worse of two.
    """
    axes = [x for x, *_ in curves]
    axis = np.linspace(start, min(float(x[-1]) for x in axes), max(x.size for x in axes))
    values = np.array([np.interp(axis, x, y) for x, y, *_ in curves])
    widths = np.array([np.interp(axis, x, high - low) for x, _, low, high, *_ in curves])
    variance = (widths / (2.0 * Z95)) ** 2
    own = variance * np.array(own_shares(axis))
    nearest = [np.abs(x[:, None] - axis).argmin(axis=0) for x in axes]
    count, flag = (
        np.array([curve[column][at] for curve, at in zip(curves, nearest, strict=True)])
        for column in (4, 5)
    )
    middle = np.sort(flag, axis=0)[len(curves) // 2]
    return _OneCurve(axis, values, own, variance - own, count.sum(axis=0), middle)


def mean_pads(tables: Sequence[Table], weights: Array) -> tuple[dict[str, Any], RandomEffects]:
    """Parts of a mean table on pads and tyre, and the scatter of level, ratio and stiffness.

    ``weights`` (k,) of the cars.
    """
    vehicle, names = tables[0].vehicle, tables[0].posterior.names
    scatter = _scatter(tables, weights)
    of_cars = inflated(scatter) ** 2
    shared = _shared([budget_of(t).level for t in tables], weights)
    level = {part: float(x) for part, x in shared.items()} | {_CARS: float(of_cars[0])}
    mean, parts = _posterior(tables, weights)
    at = names.index(RATIO)
    middle = PadLevels(float(scatter.mean[0]), float(scatter.mean[1]))
    ratio = Value(middle.ratio, float(np.sqrt(sum(part[at, at] for part in parts.values()))))
    pads, budget = calibration_of(vehicle, pad_scale(vehicle, middle), level, ratio, parts)
    covariance = tuple(map(tuple, np.sum(list(parts.values()), axis=0).tolist()))
    posterior = TyrePosterior(names, tuple(mean.tolist()), covariance)
    return {"posterior": posterior, "calibration": pads, "budget": budget}, scatter


def inflated(found: RandomEffects) -> Array:
    """Sigma of one more car (n,) whose normal 95 % interval is that of Student's t."""
    return np.asarray(quantile95(found.freedom) / Z95 * found.one_more)


def _scatter(tables: Sequence[Table], weights: Array) -> RandomEffects:
    """Of pad level, pad ratio and stiffness, logarithms [1]."""
    values = [[*pad_levels(t.vehicle, t.calibration), stiffness(t)] for t in tables]
    own = [[own_level(t), own_variance(t, RATIO), own_variance(t, COMPLIANCE)] for t in tables]
    return random_effects(np.array(values), np.array(own), weights)


def _posterior(tables: Sequence[Table], weights: Array) -> tuple[Array, dict[str, Array]]:
    """Mean, and the parts of the covariance."""
    values = np.array([t.posterior.mean for t in tables])
    own = np.array([own_covariance(t) for t in tables])
    found = random_effects(values, np.diagonal(own, axis1=1, axis2=2), weights)
    apart = values - found.mean
    together = np.einsum("i,ij,ik->jk", weights, apart, apart) + np.tensordot(weights, own, 1)
    sigma = np.sqrt(np.diag(together))
    per = np.divide(inflated(found), sigma, out=np.zeros_like(sigma), where=sigma > 0.0)
    wholes = [budget_of(t).posterior for t in tables]
    # as large as each parameter's own scatter says, correlated as the cars are
    return found.mean, _shared(wholes, weights) | {_CARS: together * np.outer(per, per)}


def _shared(of: Sequence[Mapping[str, Any]], weights: Array) -> dict[str, Array]:
    """Mean of variances by part, without the own errors."""
    out: dict[str, Array] = {}
    for weight, parts in zip(weights.tolist(), of, strict=True):
        for part, share in parts.items():
            if part not in _OWN:
                out[part] = out.get(part, np.zeros(())) + weight * np.asarray(share)
    return out


def stiffness(table: Table) -> float:
    """Logarithm of the slip stiffness of the tyres [1]."""
    return -table.posterior.value(COMPLIANCE)


def own_covariance(table: Table) -> Array:
    """Covariance of the posterior (k, k) by the errors of the table's own run."""
    n = len(table.posterior.names)
    parts = budget_of(table).posterior
    return sum((np.asarray(parts[p]) for p in _OWN if p in parts), np.zeros((n, n)))


def own_variance(table: Table, name: str) -> float:
    """Variance of a parameter by the errors of the table's own run; 0 for one that it lacks."""
    names = table.posterior.names
    return float(own_covariance(table)[(names.index(name),) * 2]) if name in names else 0.0


def own_level(table: Table) -> float:
    """Variance of the logarithm of the pad level [1] by the errors of the table's own run."""
    return sum(budget_of(table).level.get(part, 0.0) for part in _OWN)


def own_share(table: Table, eta: Array) -> Array:
    """Share of the own errors in the variance of D at ``eta`` (n,), 0 to 1."""
    return _share(table, eta, lambda e: differences(_ridge(table, e), eta))


def own_share_of_tyre(table: Table, slip: Array) -> Array:
    """The same of the tyre curve g at ``slip`` (n,)."""
    return _share(table, slip, lambda e: tyre_forces(e, slip))


def _ridge(table: Table, e: Ensemble) -> Shown:
    z = np.linspace(0.0, table.paper.decelerations[1], SETTINGS.rows)
    return ridge(table.vehicle, e, z)


def _share(table: Table, at: Array, curve: Callable[[Ensemble], Array]) -> Array:
    """Of what the parameters of the posterior explain of the draws' curves."""
    own = own_covariance(table)
    if table.draws is None or not own.any():
        return np.zeros(at.size)
    e = ensemble_of(table.vehicle, table.draws)
    x, y = (of - of.mean(axis=0) for of in (as_cubic(e, float(table.tyre.force[-1])).T, curve(e)))
    slope = np.linalg.lstsq(x, y, rcond=None)[0]
    part, whole = np.einsum("kr,kl,lr->r", slope, own, slope), (x @ slope).var(axis=0)
    # at eta = 1 both are zero
    share = np.divide(part, whole, out=np.zeros(at.size), where=whole > 0.0)
    return np.asarray(np.minimum(share, 1.0))

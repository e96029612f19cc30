"""The mean pads and tyre of several cars: posterior, calibration and budget of the mean table.

All of them are of one more car of the model, as the bands of the curves. In the budget the part
`cars` is how cars differ, with the error of the mean and the noise of one run; the other parts are
those that all cars share, as large as in one car: a mean does not make them smaller.
"""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calib.base.intervals import Z95
from calib.base.random_effects import RandomEffects, quantile95, random_effects
from calib.fitting.calibration import calibration_of
from calib.store.own_errors import OWN, own_covariance, own_level
from calib.table.budget import TableBudget
from calib.table.pad_levels import PadLevels, pad_levels, pad_scale
from calib.table.pads_budget import axle_budgets, level_of
from calib.table.table import Calibration, Table, TyrePosterior, Value

Array = NDArray[np.float64]

CARS = "cars"
"""Part of a budget that is the difference between cars."""

RATIO, COMPLIANCE = "log_pad_ratio", "log_compliance"


class MeanPads(NamedTuple):
    """What a mean table says of pads and tyre, and the scatter of level, ratio and stiffness."""

    posterior: TyrePosterior
    calibration: Calibration
    budget: TableBudget
    scatter: RandomEffects


def mean_pads(tables: Sequence[Table], weights: Array) -> MeanPads:
    """Mean of pads and tyre; ``weights`` (k,) of the cars."""
    vehicle = tables[0].vehicle
    levels = [pad_levels(t.vehicle, t.calibration) for t in tables]
    scatter = _scatter(tables, levels, weights)
    of_cars = inflated(scatter) ** 2
    level = _shared_level(tables, weights) | {CARS: float(of_cars[0])}
    names, mean, parts = _posterior(tables, weights)
    covariance = np.sum(list(parts.values()), axis=0)
    if RATIO in names:
        at = names.index(RATIO)
        ratio = {part: float(share[at, at]) for part, share in parts.items()}
    else:  # a table whose tyre knows no pads
        open_ = [t.calibration.pad_log_ratio.sigma**2 for t in tables]
        ratio = {"ramp": float(weights @ open_), CARS: float(of_cars[1])}
    middle = PadLevels(float(scatter.mean[0]), float(scatter.mean[1]))
    log_ratio = Value(middle.ratio, float(np.sqrt(sum(ratio.values()))))
    pads = calibration_of(vehicle, pad_scale(vehicle, middle), log_ratio, level)
    front, rear = axle_budgets(vehicle, pads, level, ratio)
    return MeanPads(
        posterior=TyrePosterior(
            names, tuple(mean.tolist()), _rows(covariance), _shared_scatter(tables, weights)
        ),
        calibration=pads,
        budget=TableBudget(
            front=front.relative,
            rear=rear.relative,
            level=level,
            posterior={part: _rows(share) for part, share in parts.items()},
        ),
        scatter=scatter,
    )


def inflated(found: RandomEffects) -> Array:
    """Sigma of one more car (n,) whose normal 95 % interval is that of Student's t."""
    return np.asarray(quantile95(found.freedom) / Z95 * found.one_more)


def _scatter(tables: Sequence[Table], levels: Sequence[PadLevels], weights: Array) -> RandomEffects:
    """Of pad level, pad ratio and stiffness, logarithms [1]."""
    values = [[*pads, stiffness(t)] for t, pads in zip(tables, levels, strict=True)]
    own = [[own_level(t), own_variance(t, RATIO), own_variance(t, COMPLIANCE)] for t in tables]
    return random_effects(np.array(values), np.array(own), weights)


def stiffness(table: Table) -> float:
    """Logarithm of the slip stiffness of the tyres [1]."""
    return -table.posterior.value(COMPLIANCE)


def own_variance(table: Table, name: str) -> float:
    """Variance of a parameter by the errors of the table's own run; 0 for one that it lacks."""
    names = table.posterior.names
    return float(own_covariance(table)[(names.index(name),) * 2]) if name in names else 0.0


def _posterior(
    tables: Sequence[Table], weights: Array
) -> tuple[tuple[str, ...], Array, dict[str, Array]]:
    """Names, mean and the parts of the covariance."""
    values = np.array([t.posterior.mean for t in tables])
    own = np.array([own_covariance(t) for t in tables])
    found = random_effects(values, np.diagonal(own, axis1=1, axis2=2), weights)
    apart = values - found.mean
    together = np.einsum("i,ij,ik->jk", weights, apart, apart) + np.tensordot(weights, own, 1)
    sigma = np.sqrt(np.diag(together))
    per = np.divide(inflated(found), sigma, out=np.zeros_like(sigma), where=sigma > 0.0)
    parts = _shared_parts(tables, weights)
    # as large as each parameter's own scatter says, correlated as the cars are
    return tables[0].posterior.names, found.mean, {**parts, CARS: together * np.outer(per, per)}


def _shared_level(tables: Sequence[Table], weights: Array) -> dict[str, float]:
    """Variance of the logarithm of the pad level [1] by part, without the own errors."""
    out: dict[str, float] = {}
    for weight, table in zip(weights.tolist(), tables, strict=True):
        for part, variance in level_of(table).items():
            if part not in OWN:
                out[part] = out.get(part, 0.0) + weight * variance
    return out


def _shared_parts(tables: Sequence[Table], weights: Array) -> dict[str, Array]:
    """Covariance of the posterior by part, without the own errors."""
    out: dict[str, Array] = {}
    for weight, table in zip(weights.tolist(), tables, strict=True):
        whole = {"ramp": table.posterior.covariance}
        for part, share in (whole if table.budget is None else table.budget.posterior).items():
            if part not in OWN:
                out[part] = out.get(part, np.zeros(1)) + weight * np.asarray(share)
    return out


def _shared_scatter(tables: Sequence[Table], weights: Array) -> tuple[tuple[float, ...], ...]:
    """The part of the covariance that no stop learns from: no mean makes it smaller."""
    own = [
        weight * np.asarray(table.posterior.scatter)
        for weight, table in zip(weights.tolist(), tables, strict=True)
        if table.posterior.scatter
    ]
    return _rows(np.sum(own, axis=0)) if own else ()


def _rows(matrix: Array) -> tuple[tuple[float, ...], ...]:
    even = 0.5 * (matrix + matrix.T)
    return tuple(tuple(float(x) for x in row) for row in even)

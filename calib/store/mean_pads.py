"""The mean pads and tyre of several cars: posterior, calibration and budget of the mean table.

All of them are of one more car of the model, as the bands of the curves. In the budget the part
`cars` is how cars differ, with the error of the mean and the noise of one run; the other parts are
those that all cars share, as large as in one car: a mean does not make them smaller.
"""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

import numpy as np

from calib.base.intervals import Z95
from calib.base.random_effects import RandomEffects, quantile95, random_effects
from calib.fitting.calibration import calibration_of
from calib.store.own_errors import (
    COMPLIANCE,
    OWN,
    RATIO,
    own_covariance,
    own_level,
    own_variance,
    stiffness,
)
from calib.table.budget import PadLevels, axle_budgets, level_of, pad_levels, pad_scale
from calib.table.table import Array, Calibration, Table, TableBudget, TyrePosterior, Value

_CARS = "cars"
"""Part of a budget that is the difference between cars."""


class MeanPads(NamedTuple):
    """What a mean table says of pads and tyre, and the scatter of level, ratio and stiffness."""

    posterior: TyrePosterior
    calibration: Calibration
    budget: TableBudget
    scatter: RandomEffects


def mean_pads(tables: Sequence[Table], weights: Array) -> MeanPads:
    """Mean of pads and tyre; ``weights`` (k,) of the cars."""
    vehicle, names = tables[0].vehicle, tables[0].posterior.names
    scatter = _scatter(tables, weights)
    of_cars = inflated(scatter) ** 2
    shared = _shared([level_of(t) for t in tables], weights)
    level = {part: float(x) for part, x in shared.items()} | {_CARS: float(of_cars[0])}
    mean, parts = _posterior(tables, weights)
    if RATIO in names:
        at = names.index(RATIO)
        ratio = {part: float(share[at, at]) for part, share in parts.items()}
    else:  # a table whose tyre knows no pads
        open_ = [t.calibration.pad_log_ratio.sigma**2 for t in tables]
        ratio = {"ramp": float(weights @ open_), _CARS: float(of_cars[1])}
    middle = PadLevels(float(scatter.mean[0]), float(scatter.mean[1]))
    log_ratio = Value(middle.ratio, float(np.sqrt(sum(ratio.values()))))
    pads = calibration_of(vehicle, pad_scale(vehicle, middle), log_ratio, level)
    front, rear = axle_budgets(vehicle, pads, level, ratio)
    # the part of the covariance that no stop learns from: no mean makes it smaller
    scatters = [t.posterior.scatter for t in tables]
    apart = _shared([{"": one} if one else {} for one in scatters], weights)
    return MeanPads(
        posterior=TyrePosterior(
            names,
            tuple(mean.tolist()),
            _rows(np.sum(list(parts.values()), axis=0)),
            _rows(apart[""]) if apart else (),
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
    wholes = [
        {"ramp": t.posterior.covariance} if t.budget is None else t.budget.posterior for t in tables
    ]
    # as large as each parameter's own scatter says, correlated as the cars are
    return found.mean, _shared(wholes, weights) | {_CARS: together * np.outer(per, per)}


def _shared(of: Sequence[Mapping[str, Any]], weights: Array) -> dict[str, Array]:
    """Mean of variances by part, without the own errors."""
    out: dict[str, Array] = {}
    for weight, parts in zip(weights.tolist(), of, strict=True):
        for part, share in parts.items():
            if part not in OWN:
                out[part] = out.get(part, np.zeros(())) + weight * np.asarray(share)
    return out


def _rows(matrix: Array) -> tuple[tuple[float, ...], ...]:
    even = 0.5 * (matrix + matrix.T)
    return tuple(tuple(float(x) for x in row) for row in even)

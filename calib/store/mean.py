r"""The mean of several cars: curves, pads, tyres, budget and maps of one more car of the model.

    D(eta)   1 to where the shortest table ends;  D(1) = 0 in every car, so in the mean
    f1, f2   from the mean D at the load split of the mean z(eta): (18) holds in every row
    g(slip)  0 to where the shortest ends

A band is for one more car: scatter between cars, error of the mean, noise of one run, and errors
that all cars share (`calib.table.budget`). The first three are the part `cars` of the budget, with
Student's t of k - 1 degrees of freedom for k cars. A mean does not reduce the shared errors.

    draw of a car - mean of that car + mean of a new car = draw of one more car

The cars count alike. The logarithms of pads and compliances are a normal
sample of k, so the mean of a new car follows Student's t with k - 1 degrees of freedom about m:

    sqrt((k + 1)/k) sum g_i (m_i - m)/sqrt(k - 1) / sqrt(chi^2/(k - 1))        g_i ~ N(0, 1)

The shared errors are in the draws of each car, and so in the mixture.
"""

import math
from collections.abc import Sequence
from typing import Any, NamedTuple

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import Z95
from calib.base.random_effects import RandomEffects, quantile95, random_effects
from calib.car.effects.combined import as_driven
from calib.car.model import default_model
from calib.fitting.curves import paper_of
from calib.fitting.ensemble import TABLE_DRAWS, ensemble_of
from calib.fitting.maps import maps
from calib.fitting.pads import calibration_of
from calib.table.budget import PadLevels, pad_levels, pad_scale, per_run, shared
from calib.table.curves import DifferenceCurve, TyreCurve
from calib.table.maps import Draws, LevelMap, PadMap
from calib.table.table import Table, Value

_LOGS = ("level", "ratio", "stiffness")  # logarithms in a budget
_POSITIVE = ("compliance_f", "compliance_r")  # draws whose logarithms are averaged
_OF_CARS = ("log_pad_ratio", "log_pad_level", *_POSITIVE)  # draws with a mean of each car
_SIZE = 2048  # draws for the maps


class _OneCurve(NamedTuple):
    """One curve of all k cars on a common axis (n,): values and variances (k, n)."""

    axis: Array
    values: Array
    own_variance: Array
    shared_variance: Array
    blocks: Array
    flag: Array


def mean_curves(tables: Sequence[Table]) -> tuple[dict[str, Any], RandomEffects]:
    """The curves of a mean table by name, and the scatter of D."""
    of_D, of_g = (
        _on_one_axis(start, [[*vars(getattr(t, of)).values()] for t in tables])
        for start, of in ((1.0, "difference"), (0.0, "tyre"))
    )
    scatter, columns = _mean(of_D)
    difference, tyre = DifferenceCurve(*columns), TyreCurve(*_mean(of_g)[1])
    z = np.mean([np.interp(of_D.axis, t.paper.eta, t.paper.z) for t in tables], axis=0)
    paper = paper_of(tables[0].vehicle, difference, z)
    return {"difference": difference, "paper": paper, "tyre": tyre}, scatter


def _mean(curve: _OneCurve) -> tuple[RandomEffects, tuple[Array, ...]]:
    """Scatter of a curve, and columns of its mean with the band of one more car."""
    scatter = random_effects(curve.values, curve.own_variance)
    of_cars = quantile95(scatter.freedom) * scatter.prediction_sigma
    half = np.asarray(np.hypot(of_cars, Z95 * np.sqrt(np.mean(curve.shared_variance, axis=0))))
    mean, none = scatter.mean, np.zeros(curve.axis.size)
    return scatter, (curve.axis, mean, mean - half, mean + half, curve.blocks, curve.flag, none)


def _on_one_axis(start: float, curves: Sequence[Sequence[Array]]) -> _OneCurve:
    """One curve of each car on a common axis, from ``start`` to the end of the shortest.

    Blocks of a cell are summed, of the flags it has the upper median.
    """
    end, rows = min(float(x[-1]) for x, *_ in curves), max(x.size for x, *_ in curves)
    axis = np.linspace(start, end, rows)
    values, lower, upper, count, flag, of_run = (
        np.array([np.interp(axis, curve[0], curve[i]) for curve in curves]) for i in range(1, 7)
    )
    variance = ((upper - lower) / (2.0 * Z95)) ** 2
    parts = variance * of_run, variance * (1.0 - of_run)
    blocks, middle = np.rint(count.sum(axis=0)), np.ceil(np.median(flag, axis=0))
    return _OneCurve(axis, values, *parts, blocks, middle)


def mean_pads(tables: Sequence[Table]) -> tuple[dict[str, Any], RandomEffects]:
    """Calibration and budget of a mean; the scatter of level, ratio and stiffness."""
    vehicle = tables[0].vehicle
    values = [
        [*pad_levels(t.vehicle, t.calibration), math.log(t.calibration.slip_stiffness.value)]
        for t in tables
    ]
    of_run = [[per_run(getattr(t.budget, name)) for name in _LOGS] for t in tables]
    scatter = random_effects(np.array(values), np.array(of_run))
    level, ratio, stiffness = scatter.mean.tolist()
    parts: dict[str, dict[str, float]] = {}
    for name, of_cars in zip(_LOGS, (inflated(scatter) ** 2).tolist(), strict=True):
        each = [shared(getattr(t.budget, name)) for t in tables]
        common = {part: [x.get(part, 0.0) for x in each] for budget in each for part in budget}
        means = {part: float(np.mean(variances)) for part, variances in common.items()}
        parts[name] = {**means, "cars": of_cars}
    of_ratio, of_stiffness = (math.sqrt(sum(parts[name].values())) for name in _LOGS[1:])
    pads, budget = calibration_of(
        vehicle,
        pad_scale(vehicle, PadLevels(level, ratio)),
        Value(ratio, of_ratio),
        Value(stiffness, of_stiffness),
        parts,
    )
    return {"calibration": pads, "budget": budget}, scatter


def inflated(scatter: RandomEffects) -> Array:
    """Sigma of one more car (n,) whose normal 95 % interval is that of Student's t."""
    return np.asarray(quantile95(scatter.freedom) / Z95 * scatter.prediction_sigma)


def mean_maps(tables: Sequence[Table]) -> tuple[PadMap, LevelMap, Draws]:
    """Maps and draws of one more car, from the tables of k cars."""
    vehicle = tables[0].vehicle
    car = as_driven(vehicle, default_model(vehicle).effects)
    drawn = one_more(tables)
    rows = np.linspace(0, _SIZE - 1, TABLE_DRAWS).astype(np.int64)
    part = Draws(**{name: x[rows] for name, x in vars(drawn).items()})
    return *maps(car, ensemble_of(car, drawn)), part


def one_more(tables: Sequence[Table], size: int = _SIZE) -> Draws:
    """``size`` draws of one more car, by a fixed random sequence."""
    draws = [vars(t.draws) for t in tables]
    k, rng = len(draws), np.random.default_rng(42)
    car = np.arange(size) * k // size
    row = (rng.random(size) * [draws[i]["weight"].size for i in car]).astype(np.int64)
    g = rng.standard_normal((size, k)) / np.sqrt(k - 1.0)
    tails = np.sqrt((k - 1.0) / rng.chisquare(k - 1, size))
    far = np.sqrt(1.0 + 1.0 / k) * np.minimum(tails, quantile95(k - 1))
    out = {}
    for name in draws[0]:
        columns = [np.log(d[name]) if name in _POSITIVE else d[name] for d in draws]
        x = np.array([columns[i][j] for i, j in zip(car, row, strict=True)])
        if name in _OF_CARS:
            means = np.array([np.mean(column) for column in columns])
            off = means - np.mean(means)
            x += far * (g @ off) - off[car]
        out[name] = np.exp(x) if name in _POSITIVE else x
    return Draws(**out)

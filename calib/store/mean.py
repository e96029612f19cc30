r"""The mean of the tables of k cars of one model: curves, pads, budget and maps.

    D(eta)   eta from 1 to where the shortest table ends;  D(1) = 0 in every car and in the mean
    f1, f2   the mean D, divided by the axle loads at the mean z(eta): (18) holds in every row
    g(slip)  slip from 0 to where the shortest table ends

Bands are for one more car. They count the scatter between cars, the error of the mean, the noise of
one run, and errors that all cars share. The first three have Student's t of k - 1 degrees of
freedom; in the budget (`calib.table.budget`) they are the part `cars`. A mean does not reduce the
shared errors.

The maps come from draws of one more car. A draw i of car j is moved to a new car (`one_more`):

    draw of one more car = draw i of car j - m_j + mean of the new car

m_j is the mean of the draws of car j. Logarithms of pads and compliances are normal between cars,
so the mean of a new car follows Student's t about the mean m of the m_j:

    mean of the new car = m + sqrt(1 + 1/k) T sum_j g_j (m_j - m)/sqrt(k - 1),
    g_j ~ N(0, 1),  T = sqrt((k - 1)/chi^2 of k - 1)

The shared errors are in the draws of each car, and so in the draws of one more car.
"""

import math
from collections.abc import Sequence
from typing import Any

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
from calib.table.budget import LevelAndRatio, level_and_ratio, pad_scale, per_run, shared
from calib.table.curves import DifferenceCurve, TyreCurve
from calib.table.maps import Draws, LevelMap, PadMap
from calib.table.table import Table, Value

_LOGARITHMS = ("level", "ratio", "stiffness")  # of pads and tyres, as in a `TableBudget`
_POSITIVE = ("compliance_f", "compliance_r")  # draws whose logarithms are averaged
_PER_CAR = ("log_pad_ratio", "log_pad_level", *_POSITIVE)  # draws with another mean in each car
_SIZE = 2048  # draws for the maps; a table stores TABLE_DRAWS of them


def mean_curves(tables: Sequence[Table]) -> tuple[dict[str, Any], RandomEffects]:
    """Return the curves of a mean table by name, and the scatter of D."""
    columns, D_scatter = _mean_curve(1.0, [table.difference for table in tables])
    difference = DifferenceCurve(*columns)
    columns, _ = _mean_curve(0.0, [table.tyre for table in tables])
    z = [np.interp(difference.eta, table.paper.eta, table.paper.z) for table in tables]
    paper = paper_of(tables[0].vehicle, difference, np.mean(z, axis=0))
    return {"difference": difference, "paper": paper, "tyre": TyreCurve(*columns)}, D_scatter


def _mean_curve(
    start: float, curves: Sequence[DifferenceCurve] | Sequence[TyreCurve]
) -> tuple[tuple[Array, ...], RandomEffects]:
    """Return the columns of the mean of the curves of k cars, and the scatter between the cars.

    Columns are as in `DifferenceCurve`; the band is that of one more car. The axis has n rows from
    ``start`` to the end of the shortest curve.
    """
    cars = [[*vars(curve).values()] for curve in curves]  # seven columns each, the axis first
    end = min(float(columns[0][-1]) for columns in cars)
    axis = np.linspace(start, end, max(columns[0].size for columns in cars))
    values, lower, upper, count, flag, run_share = (  # (k, n) each, as in the curve
        np.array([np.interp(axis, columns[0], columns[i]) for columns in cars]) for i in range(1, 7)
    )
    variance = ((upper - lower) / (2.0 * Z95)) ** 2
    scatter = random_effects(values, variance * run_share)
    of_cars = quantile95(scatter.freedom) * scatter.prediction_sigma  # (n,)
    of_shared = Z95 * np.sqrt(np.mean(variance * (1.0 - run_share), axis=0))
    half_width = np.asarray(np.hypot(of_cars, of_shared))
    blocks = np.rint(count.sum(axis=0))
    middle_flag = np.ceil(np.median(flag, axis=0))  # of two middle flags the worse
    band = scatter.mean - half_width, scatter.mean + half_width
    no_run_share = np.zeros(axis.size)  # as in every mean of cars
    return (axis, scatter.mean, *band, blocks, middle_flag, no_run_share), scatter


def mean_pads(tables: Sequence[Table]) -> tuple[dict[str, Any], RandomEffects]:
    """Return calibration and budget of a mean table, and the scatter of the `_LOGARITHMS`."""
    vehicle = tables[0].vehicle
    values, per_run_variances = [], []  # (k, 3)
    for table in tables:
        stiffness = table.calibration.slip_stiffness.value
        values.append([*level_and_ratio(table.vehicle, table.calibration), math.log(stiffness)])
        budget = vars(table.budget)
        per_run_variances.append([per_run(budget[name]) for name in _LOGARITHMS])
    scatter = random_effects(np.array(values), np.array(per_run_variances))

    parts: dict[str, dict[str, float]] = {}
    for name, of_cars in zip(_LOGARITHMS, (inflated(scatter) ** 2).tolist(), strict=True):
        parts[name] = _mean_shared(tables, name) | {"cars": of_cars}
    level, ratio, stiffness = scatter.mean.tolist()
    pads, mean_budget = calibration_of(
        vehicle,
        pad_scale(vehicle, LevelAndRatio(level, ratio)),
        Value(ratio, math.sqrt(sum(parts["ratio"].values()))),
        Value(stiffness, math.sqrt(sum(parts["stiffness"].values()))),
        parts,
    )
    return {"calibration": pads, "budget": mean_budget}, scatter


def _mean_shared(tables: Sequence[Table], name: str) -> dict[str, float]:
    """Return each part of the shared variance of a logarithm, as its mean over the cars."""
    cars = [shared(getattr(table.budget, name)) for table in tables]
    parts = dict.fromkeys(part for variances in cars for part in variances)
    return {part: float(np.mean([car.get(part, 0.0) for car in cars])) for part in parts}


def inflated(scatter: RandomEffects) -> Array:
    """Return the sigma (n,) whose normal 95 % interval is that of one more car by Student's t."""
    return np.asarray(quantile95(scatter.freedom) / Z95 * scatter.prediction_sigma)


def mean_maps(tables: Sequence[Table]) -> tuple[PadMap, LevelMap, Draws]:
    """Return maps and draws of one more car."""
    vehicle = tables[0].vehicle
    car = as_driven(vehicle, default_model(vehicle).effects)
    drawn = one_more(tables)
    pad_map, level_map = maps(car, ensemble_of(car, drawn))
    rows = np.linspace(0, _SIZE - 1, TABLE_DRAWS).astype(np.int64)
    stored = Draws(**{name: column[rows] for name, column in vars(drawn).items()})
    return pad_map, level_map, stored


def one_more(tables: Sequence[Table], size: int = _SIZE) -> Draws:
    """Return ``size`` draws of one more car, by a fixed random sequence.

    Each car gives the same number of draws. T is limited to `quantile95`, an arbitrary bound: with
    few cars a larger T could make a compliance overflow.
    """
    draws = [vars(table.draws) for table in tables]
    k, rng = len(draws), np.random.default_rng(42)
    car = np.arange(size) * k // size  # j of each draw, (size,)
    counts = np.array([columns["weight"].size for columns in draws])  # (k,)
    row = (rng.random(size) * counts[car]).astype(np.int64)  # i of each draw, (size,)
    g = rng.standard_normal((size, k)) / np.sqrt(k - 1.0)
    T = np.minimum(np.sqrt((k - 1.0) / rng.chisquare(k - 1, size)), quantile95(k - 1))
    columns = {}
    for name in draws[0]:
        of_cars = [np.log(d[name]) if name in _POSITIVE else d[name] for d in draws]
        x = np.array([of_cars[j][i] for j, i in zip(car, row, strict=True)])
        if name in _PER_CAR:
            means = np.array([np.mean(column) for column in of_cars])  # m_j, (k,)
            deviations = means - np.mean(means)  # m_j - m
            x += np.sqrt(1.0 + 1.0 / k) * T * (g @ deviations) - deviations[car]
        columns[name] = np.exp(x) if name in _POSITIVE else x
    return Draws(**columns)

r"""Draws and maps of a mean table: one more car of the model, drawn from those that were measured.

    draw of a car --less the mean of the car, plus one more mean--> draw of one more car

Cars count by their weights in the mean. Their means of pads and compliances, logarithms, scatter as
a normal sample of k: one more is of Student's distribution with k - 1 degrees of freedom about
their mean, along the same directions as the cars,

    sqrt((k + 1)/k) sum g_i (m_i - m)/sqrt(k - 1) / sqrt(chi^2/(k - 1))        g_i ~ N(0, 1)

What all cars share is in the draws of each, and so in the mixture.
"""

from collections.abc import Sequence

import numpy as np

from calib.base.arrays import Array
from calib.base.random_effects import quantile95
from calib.car.effects.combined import as_driven
from calib.car.model import default_model
from calib.fitting.ensemble import KEPT, ensemble_of
from calib.fitting.maps import maps
from calib.table.maps import Draws, LevelMap, PadMap
from calib.table.table import Table

_POSITIVE = ("compliance_f", "compliance_r")
"""Columns of which the logarithm scatters."""

_OF_CARS = ("log_pad_ratio", "log_pad_level", *_POSITIVE)
"""Columns in which cars differ beyond what each leaves open."""

_SIZE = 2048
"""Draws of which the maps are made."""


def mean_maps(tables: Sequence[Table], weights: Array) -> tuple[PadMap, LevelMap, Draws]:
    """Maps and draws of one more car of a model, from ``tables`` with ``weights`` (k,)."""
    vehicle = tables[0].vehicle
    car = as_driven(vehicle, default_model(vehicle).effects)
    drawn = one_more(tables, weights)
    kept = np.linspace(0, _SIZE - 1, KEPT).astype(np.int64)
    part = Draws(**{name: x[kept] for name, x in vars(drawn).items()})
    return *maps(car, ensemble_of(car, drawn)), part


def one_more(tables: Sequence[Table], weights: Array, size: int = _SIZE) -> Draws:
    """``size`` draws of one more car, by a fixed sequence."""
    draws = [vars(t.draws) for t in tables]
    k, rng = len(draws), np.random.default_rng(42)
    car = np.searchsorted(np.cumsum(weights), (np.arange(size) + 0.5) / size * np.sum(weights))
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
            off = means - weights @ means
            x += far * (g @ off) - off[car]
        out[name] = np.exp(x) if name in _POSITIVE else x
    return Draws(**out)

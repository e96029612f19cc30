"""The figures of a mean table that a person reads: mean, how well it is known, how cars differ."""

from dataclasses import dataclass

import numpy as np

from calib.base.random_effects import quantile95
from calib.store.mean_pads import stiffness
from calib.table.pad_levels import pad_levels
from calib.table.spread import Scatter
from calib.table.table import Table


@dataclass(frozen=True)
class MeanFigure:
    """``value`` [1] of the mean, relative half width of its 95 % interval, and sigma of the cars.

    ``half_width`` and ``between`` are shares of the value [1]. The interval holds what differs from
    car to car and not what all of them share.
    """

    name: str
    value: float
    half_width: float
    between: float


def mean_figures(table: Table) -> tuple[MeanFigure, ...]:
    """Figures of a mean table: D where it is largest, pad level, pad ratio, slip stiffness.

    Pads are over those of the vehicle file. Empty for a table of one car.
    """
    spread = table.spread
    if spread is None:
        return ()
    t95 = quantile95(spread.freedom)
    row = int(np.argmax(np.abs(table.difference.D)))
    eta, D = table.difference.peak
    pads = pad_levels(table.vehicle, table.calibration)

    def figure(name: str, value: float, of: Scatter, scale: float = 1.0) -> MeanFigure:
        return MeanFigure(name, value, t95 * of.of_mean / scale, of.between / scale)

    return (
        figure(f"D at eta {eta:.5f}", D, spread.D[row], abs(D)),
        figure("pad level", float(np.exp(pads.level)), spread.pad_level),
        figure("pad ratio", float(np.exp(pads.ratio)), spread.pad_ratio),
        figure("slip stiffness", float(np.exp(stiffness(table))), spread.stiffness),
    )

"""How many sigma of its fleet a car is away from a golden table that is the mean of several cars.

    t = (car - mean)/sqrt(between^2 + error of the mean^2 + own error of the car^2)

With few cars the scatter between them is hardly known, so t is of Student's distribution with one
degree of freedom less than the golden table has cars. It is turned into the number of sigma that is
as rare in a normal distribution: 3 sigma are one good car in 370, whatever the number of cars.

What the car and the cars of the golden table share (vehicle file, track, method) is in both and
cancels. It does not where they were measured in other ways, as with and without v.
"""

import math
from dataclasses import dataclass

import numpy as np

from calib.base.intervals import Z95
from calib.base.random_effects import as_sigma
from calib.line.station.golden import common_end
from calib.store.own_errors import (
    COMPLIANCE,
    RATIO,
    own_level,
    own_share,
    own_variance,
    stiffness,
)
from calib.table.budget import pad_levels
from calib.table.table import Scatter, Table


@dataclass(frozen=True)
class FleetSigma:
    """Sigma [1] of a car, positive above the mean.

    ``D`` at the row of the golden table with the largest D that both reach, None where less than
    half of its range is common; ``pad_level`` of both axles, ``pad_ratio``, ``stiffness`` of tyres.
    """

    D: float | None
    pad_level: float
    pad_ratio: float
    stiffness: float


def fleet_sigma(table: Table, golden: Table) -> FleetSigma | None:
    """Sigma of a car's ``table``; None for a golden table of one car, which knows no fleet."""
    spread = golden.spread
    if spread is None:
        return None
    ours = pad_levels(table.vehicle, table.calibration)
    theirs = pad_levels(golden.vehicle, golden.calibration)
    soft = stiffness(table) - stiffness(golden)

    def sigma(apart: float, of: Scatter, own: float) -> float:
        return _sigma(apart, of, own, spread.freedom)

    return FleetSigma(
        D=_of_D(table, golden, spread.D, spread.freedom),
        pad_level=sigma(ours.level - theirs.level, spread.pad_level, own_level(table)),
        pad_ratio=sigma(ours.ratio - theirs.ratio, spread.pad_ratio, own_variance(table, RATIO)),
        stiffness=sigma(soft, spread.stiffness, own_variance(table, COMPLIANCE)),
    )


def _of_D(table: Table, golden: Table, scatter: tuple[Scatter, ...], freedom: int) -> float | None:
    end = common_end(table, golden)
    if end is None:
        return None
    d, theirs = table.difference, golden.difference
    row = int(np.argmax(np.where(theirs.eta <= end, np.abs(theirs.D), -1.0)))
    eta = theirs.eta[row : row + 1]
    sigma = np.interp(eta, d.eta, d.upper - d.lower) / (2.0 * Z95)
    own = float((sigma**2 * own_share(table, eta))[0])
    apart = float((np.interp(eta, d.eta, d.D) - theirs.D[row])[0])
    return _sigma(apart, scatter[row], own, freedom)


def _sigma(apart: float, of: Scatter, own: float, freedom: int) -> float:
    predicted = math.sqrt(of.between**2 + of.of_mean**2 + own)
    if predicted == 0.0:
        return as_sigma(math.copysign(math.inf, apart), freedom) if apart else 0.0
    return as_sigma(apart / predicted, freedom)

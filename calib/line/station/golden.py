"""Distance of a car's table from the golden table of its model: D(eta), pads, tyres.

D = C (eta - 1) and the stiffness of the tyres depend on the road, the pads do not: the golden table
must be of the same track. D is compared where both tables are measured.

Against a golden table that is the mean of several cars, also in sigma of their fleet:

    t = (car - mean)/sqrt(between^2 + error of the mean^2 + own error of the car^2)

t has Student's distribution with one degree of freedom less than the golden table has cars. It is
given as the normal deviate of the same p: beyond 3 sigma is one good car in 370. What car and fleet
share (vehicle file, track, method) cancels, unless one has v and the other not.
"""

import math

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import StoreError
from calib.base.intervals import Z95
from calib.base.random_effects import normal_equivalent
from calib.store.store import Store
from calib.store.version import Stored
from calib.table.budget import pad_levels, per_run
from calib.table.table import FleetScatter, Scatter, Table

_OVERLAP = 0.5
"""Least share of the golden table's range of eta that a car's table must have for a distance."""


def golden_table(store: Store, reference: str) -> Stored:
    """Return a golden table: released, or a draft named by its version. Raises StoreError."""
    stored = store.released(reference)
    if not (stored.state.usable and stored.state.in_store):
        raise StoreError(
            f"is {stored.state.description}; no car is measured by it",
            where=stored.id,
            expected="a released version",
        )
    return stored


def golden_metrics(table: Table, golden: Table) -> dict[str, float]:
    """The `golden_` metrics of the car that both tables give.

    Those of D need `_OVERLAP`, those in sigma a golden table of several cars.
    """
    ours, theirs = table.calibration, golden.calibration
    metrics = {
        "golden_pads_f": ours.pad_friction_f.value / theirs.pad_friction_f.value - 1.0,
        "golden_pads_r": ours.pad_friction_r.value / theirs.pad_friction_r.value - 1.0,
        "golden_stiffness": ours.slip_stiffness.value / theirs.slip_stiffness.value - 1.0,
    }
    golden_end = float(golden.difference.eta[-1])
    end = min(float(table.difference.eta[-1]), golden_end)
    common = end - 1.0 >= _OVERLAP * (golden_end - 1.0)
    if common:
        metrics |= _distance(table, golden, end)
    if golden.spread is not None:
        metrics |= _sigmas(table, golden, golden.spread, end if common else None)
    return metrics


def _distance(table: Table, golden: Table, end: float) -> dict[str, float]:
    """Largest difference of D up to ``end``, over the golden peak and over its 95 % half width."""
    ours, theirs = table.difference, golden.difference
    # both are linear between their rows, so the largest difference is at a row of one of them
    rows = np.union1d(ours.eta, theirs.eta)
    eta = rows[(rows > 1.0) & (rows <= end)]
    a, b = (np.interp(eta, d.eta, d.D) for d in (ours, theirs))
    widths = [0.5 * np.interp(eta, d.eta, d.upper - d.lower) for d in (ours, theirs)]
    difference: Array = np.abs(a - b)
    worst = int(np.argmax(difference))
    largest, width = float(difference[worst]), float(np.hypot(*widths)[worst])
    return {
        "golden_distance": largest / abs(theirs.peak[1]),
        "golden_bands": largest / width if width > 0.0 else math.inf if largest > 0.0 else 0.0,
    }


def _sigmas(
    table: Table, golden: Table, spread: FleetScatter, end: float | None
) -> dict[str, float]:
    """Pads and tyres in sigma, and D where it is largest up to ``end`` in the golden table."""
    ours, theirs = (pad_levels(t.vehicle, t.calibration) for t in (table, golden))
    stiffness, mean = (t.calibration.slip_stiffness.value for t in (table, golden))
    budget = table.budget
    parts = {
        "level": (ours.level - theirs.level, spread.pad_level, per_run(budget.level)),
        "ratio": (ours.ratio - theirs.ratio, spread.pad_ratio, per_run(budget.ratio)),
        "stiffness": (math.log(stiffness / mean), spread.stiffness, per_run(budget.stiffness)),
    }
    if end is not None:
        d, reference = table.difference, golden.difference
        row = int(np.argmax(np.where(reference.eta <= end, np.abs(reference.D), -1.0)))
        D, upper, lower, own = (
            float(np.interp(reference.eta[row], d.eta, x)) for x in (d.D, d.upper, d.lower, d.own)
        )
        of_run = ((upper - lower) / (2.0 * Z95)) ** 2 * own
        parts["d"] = (D - float(reference.D[row]), spread.D[row], of_run)
    return {f"golden_sigma_{k}": _sigma(*part, spread.freedom) for k, part in parts.items()}


def _sigma(difference: float, scatter: Scatter, variance: float, freedom: int) -> float:
    predicted = math.sqrt(scatter.between**2 + scatter.of_mean**2 + variance)
    if predicted == 0.0:
        return (
            normal_equivalent(math.copysign(math.inf, difference), freedom) if difference else 0.0
        )
    return normal_equivalent(difference / predicted, freedom)

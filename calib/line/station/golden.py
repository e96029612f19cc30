"""How far a car's table is from the golden table of its model: D(eta), pads, tyres.

D is compared where both are measured. D = C (eta - 1) depends on the road, so the golden table has
to be one of the same track; so does the stiffness of the tyres, while that of the pads does not.

Against a golden table that is the mean of several cars, also in sigma of their fleet:

    t = (car - mean)/sqrt(between^2 + error of the mean^2 + own error of the car^2)

t is of Student's distribution with one degree of freedom less than the golden table has cars, and
is told as the sigma that is as rare in a normal one: 3 sigma are one good car in 370. What the car
and the fleet share (vehicle file, track, method) cancels; not so with and without v.
"""

import math

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import StoreError
from calib.base.intervals import Z95
from calib.base.random_effects import as_sigma
from calib.store.store import Store
from calib.store.version import Stored
from calib.table.budget import pad_levels, per_run
from calib.table.table import FleetScatter, Scatter, Table

_OVERLAP = 0.5
"""Share of the golden table's range of eta that must be common for a distance to mean anything."""


def golden_table(store: Store, reference: str) -> Stored:
    """Return the table by which others are measured: released, or a draft named by its version.

    Raises StoreError for another one, and for one without maps.
    """
    stored = store.released(reference)
    if not (stored.state.usable and stored.state.in_store):
        raise StoreError(
            f"is {stored.state.words}; no car is measured by it",
            where=stored.id,
            expected="a released version",
        )
    return stored


def golden_metrics(table: Table, golden: Table) -> dict[str, float]:
    """The metrics of the car with `golden` in their names, as far as both tables give them.

    Those of D need half of the golden range of eta; sigma needs a golden table of several cars.
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
    """Largest departure of D up to ``end``: over the golden peak, and over the 95 % half widths.

    The latter at the same eta, since near 1 both widths go to zero; infinite without any band.
    """
    ours, theirs = table.difference, golden.difference
    # both are linear between their rows, so the largest departure is at a row of one of them
    rows = np.union1d(ours.eta, theirs.eta)
    eta = rows[(rows > 1.0) & (rows <= end)]
    a, b = (np.interp(eta, d.eta, d.D) for d in (ours, theirs))
    widths = [0.5 * np.interp(eta, d.eta, d.upper - d.lower) for d in (ours, theirs)]
    apart: Array = np.abs(a - b)
    worst = int(np.argmax(apart))
    largest, width = float(apart[worst]), float(np.hypot(*widths)[worst])
    return {
        "golden_distance": largest / abs(theirs.peak[1]),
        "golden_bands": largest / width if width > 0.0 else math.inf if largest > 0.0 else 0.0,
    }


def _sigmas(
    table: Table, golden: Table, spread: FleetScatter, end: float | None
) -> dict[str, float]:
    """Pads, tyres, and D at the row of the golden table with the largest D that both reach."""
    (ours, stiff), (theirs, usual) = (
        (pad_levels(t.vehicle, t.calibration), t.calibration.slip_stiffness.value)
        for t in (table, golden)
    )
    rests = table.budget
    parts = {
        "level": (ours.level - theirs.level, spread.pad_level, per_run(rests.level)),
        "ratio": (ours.ratio - theirs.ratio, spread.pad_ratio, per_run(rests.ratio)),
        "stiffness": (math.log(stiff / usual), spread.stiffness, per_run(rests.stiffness)),
    }
    if end is not None:
        d, mean = table.difference, golden.difference
        row = int(np.argmax(np.where(mean.eta <= end, np.abs(mean.D), -1.0)))
        D, upper, lower, own = (
            float(np.interp(mean.eta[row], d.eta, x)) for x in (d.D, d.upper, d.lower, d.own)
        )
        of_run = ((upper - lower) / (2.0 * Z95)) ** 2 * own
        parts["d"] = (D - float(mean.D[row]), spread.D[row], of_run)
    return {f"golden_sigma_{k}": _sigma(*part, spread.freedom) for k, part in parts.items()}


def _sigma(apart: float, scatter: Scatter, variance: float, freedom: int) -> float:
    predicted = math.sqrt(scatter.between**2 + scatter.of_mean**2 + variance)
    if predicted == 0.0:
        return as_sigma(math.copysign(math.inf, apart), freedom) if apart else 0.0
    return as_sigma(apart / predicted, freedom)

"""Distance of a car's table from the golden table of its model, in D(eta), pads and tyres.

A golden table is the released table of a good car, or the mean of several good cars, which are then
its fleet. It must be of the same track: D is about K (eta - 1), and the slip stiffness K depends on
the road. D is compared up to the end of the shorter curve.

The mean of several cars gives the distance also in sigma of these cars:

    t = (car - mean)/sqrt(between^2 + error of the mean^2 + error of one run of the car^2)

t has Student's distribution with one degree of freedom less than the golden table has cars. Each
`golden_sigma` is the normal deviate of the same probability: beyond 3 is one good car in 370.
Errors that car and golden cars share (vehicle file, track, method) cancel, unless one log has v and
another not.
"""

import math

import numpy as np

from calib.base.errors import StoreError
from calib.base.intervals import Z95
from calib.base.random_effects import normal_equivalent
from calib.store.store import Store
from calib.store.version import Stored
from calib.table.budget import level_and_ratio, per_run
from calib.table.table import FleetScatter, Scatter, Table

_OVERLAP = 0.5  # share of the golden range of eta [1] that a car's table must cover to compare D


def golden_table(store: Store, reference: str) -> Stored:
    """Return a released table, or a draft by its version. Raises StoreError for other tables."""
    stored = store.released(reference)
    if not (stored.state.usable and stored.state.in_store):
        flaw = f"is {stored.state.description}; no car is measured by it"
        raise StoreError(flaw, where=stored.id, expected="a released version")
    return stored


def golden_metrics(table: Table, golden: Table) -> dict[str, float]:
    """Return the `golden_` metrics. Those in sigma need a golden table of several cars."""
    pads, golden_pads = table.calibration, golden.calibration
    metrics = {
        "golden_pads_f": pads.pad_friction_f.value / golden_pads.pad_friction_f.value - 1.0,
        "golden_pads_r": pads.pad_friction_r.value / golden_pads.pad_friction_r.value - 1.0,
        "golden_stiffness": pads.slip_stiffness.value / golden_pads.slip_stiffness.value - 1.0,
    }
    golden_end = float(golden.difference.eta[-1])
    end = min(float(table.difference.eta[-1]), golden_end)
    overlaps = end - 1.0 >= _OVERLAP * (golden_end - 1.0)
    if overlaps:
        metrics |= _distance(table, golden, end)
    if golden.spread is not None:
        metrics |= _sigmas(table, golden, golden.spread, end if overlaps else None)
    return metrics


def _distance(table: Table, golden: Table, end: float) -> dict[str, float]:
    """Return the largest difference of D up to eta = ``end``, over the peak and over the bands."""
    curves = table.difference, golden.difference
    # both curves are linear between rows, so their difference is largest at a row of one of them
    rows = np.union1d(*(curve.eta for curve in curves))
    eta = rows[(rows > 1.0) & (rows <= end)]
    D, golden_D = (np.interp(eta, curve.eta, curve.D) for curve in curves)
    widths = [0.5 * np.interp(eta, curve.eta, curve.upper - curve.lower) for curve in curves]
    worst = int(np.argmax(np.abs(D - golden_D)))
    largest, width = float(np.abs(D - golden_D)[worst]), float(np.hypot(*widths)[worst])
    bands = 0.0
    if largest > 0.0:
        bands = largest / width if width > 0.0 else math.inf
    return {"golden_distance": largest / abs(golden.difference.peak[1]), "golden_bands": bands}


def _sigmas(
    table: Table, golden: Table, spread: FleetScatter, end: float | None
) -> dict[str, float]:
    """Return the distances in sigma of pads and tyres, and of the largest D up to eta = ``end``."""
    pads, golden_pads = (level_and_ratio(t.vehicle, t.calibration) for t in (table, golden))
    stiffness, mean = (t.calibration.slip_stiffness.value for t in (table, golden))
    budget, freedom = table.budget, spread.freedom
    logarithms = (  # name, difference from the mean, scatter of the cars, variances by part
        ("level", pads.level - golden_pads.level, spread.pad_level, budget.level),
        ("ratio", pads.ratio - golden_pads.ratio, spread.pad_ratio, budget.ratio),
        ("stiffness", math.log(stiffness / mean), spread.stiffness, budget.stiffness),
    )
    sigmas = {}
    for name, difference, scatter, variances in logarithms:
        sigmas[f"golden_sigma_{name}"] = _sigma(difference, scatter, per_run(variances), freedom)
    if end is not None:
        curve, golden_curve = table.difference, golden.difference
        row = int(np.argmax(np.where(golden_curve.eta <= end, np.abs(golden_curve.D), -1.0)))
        eta, columns = golden_curve.eta[row], (curve.D, curve.upper, curve.lower, curve.own)
        D, upper, lower, run_share = (float(np.interp(eta, curve.eta, x)) for x in columns)
        per_run_variance = ((upper - lower) / (2.0 * Z95)) ** 2 * run_share
        difference = D - float(golden_curve.D[row])
        sigmas["golden_sigma_d"] = _sigma(difference, spread.D[row], per_run_variance, freedom)
    return sigmas


def _sigma(difference: float, scatter: Scatter, per_run_variance: float, freedom: int) -> float:
    """Return the normal deviate of t, see the head of this file."""
    if difference == 0.0:
        return 0.0
    sigma = math.sqrt(scatter.between**2 + scatter.of_mean**2 + per_run_variance)
    t = difference / sigma if sigma > 0.0 else math.copysign(math.inf, difference)
    return normal_equivalent(t, freedom)

r"""The three look-ups of a table from an ensemble: D(eta), f1 and f2(eta), and g(slip).

On a ramp the deceleration z orders everything, so z is the parameter; nothing is binned by eta.

       eta            The rising branch ends at the peak of eta. Beyond it the same eta is met
        |    __.      again at a higher z with another f1: f1 and f2 of Fig. 6 end there.
        |  /    \
        | /
        +------- z

Every draw has its D at an eta; the table has their median and the middle 95 %.
"""

import numpy as np
from numpy.typing import NDArray

from calib.car.forces import paper_curves
from calib.car.tyre_forms import NEAR_PEAK, inverse_forms
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble
from calib.fitting.one_axle_ramps import with_both_axles
from calib.fitting.ridge import Ridge, ridge
from calib.model.ramp import RampRun
from calib.model.settings import SETTINGS
from calib.table.table import (
    EXTRAPOLATED,
    INTERPOLATED,
    MEASURED,
    DifferenceCurve,
    PaperCurves,
    TyreCurve,
)

Array = NDArray[np.float64]

_BAND = (0.025, 0.5, 0.975)


def difference_curves(
    vehicle: Vehicle, e: Ensemble, runs: list[RampRun], z_end: float
) -> tuple[DifferenceCurve, PaperCurves]:
    """D(eta) over the rising branch, up to ``z_end`` [1], and f1, f2(eta) of Fig. 6 from it.

    The band is that of D at a given eta. f1 and f2 are at the load split of the ramp's z; (18) is
    exact.
    """
    z = np.linspace(0.0, z_end, SETTINGS.rows)
    of = ridge(vehicle, e, z)
    eta = np.linspace(1.0, float(of.middle[-1]), SETTINGS.rows)
    lower, D, upper = np.quantile(differences(of, eta), _BAND, axis=0)
    measured = [
        run.since_rolling(run.blocks.eta)[run.use & ~run.blocks.lead_in]
        for run in with_both_axles(runs)
    ]
    count = _count(eta, 1.0 + np.concatenate(measured))
    flags = _flags(count)
    at = np.interp(eta, of.middle, z)
    f1, f2 = paper_curves(vehicle, at, D)
    f1_a, f2_a = paper_curves(vehicle, at, lower)
    f1_b, f2_b = paper_curves(vehicle, at, upper)
    return (
        DifferenceCurve(eta, D, lower, upper, count, flags),
        PaperCurves(eta, at, f1, f1_a, f1_b, f2, f2_b, f2_a, count, flags),
    )


def tyre_curve(e: Ensemble, runs: list[RampRun], of: Ridge) -> TyreCurve:
    """Normalised force over slip with half the weight on the axle, up to the greatest measured.

    Draws have no more force than `NEAR_PEAK` of their peak.
    """
    greatest = 1.1 * float(np.median(np.maximum(of.F_f, of.F_r)[:, -1]))
    tyres = list(zip(*_tyres(e), strict=True))
    end = np.median([np.interp(greatest, force, slip) for slip, force in tyres])
    grid = np.linspace(0.0, float(end), SETTINGS.rows)
    lower, g, upper = np.quantile(tyre_forces(e, grid), _BAND, axis=0)
    seen = np.median([of.slip_f, of.slip_r], axis=1)
    shown = [
        np.interp(run.blocks.z[run.use], of.z, s) for run in with_both_axles(runs) for s in seen
    ]
    count = _count(grid, np.concatenate(shown))
    return TyreCurve(grid, g, lower, upper, count, _flags(count))


def differences(of: Ridge, eta: Array) -> Array:
    """D of the draws of a ridge at ``eta`` (k,) of its rising branch, (n, k) [1]."""
    rows = zip(np.maximum.accumulate(of.eta, axis=1), of.D, strict=True)
    return np.array([np.interp(eta, x, D) for x, D in rows])


def tyre_forces(e: Ensemble, slip: Array) -> Array:
    """g of the draws at ``slip`` (k,), (n, k) [1]."""
    return np.array([np.interp(slip, x, g) for x, g in zip(*_tyres(e), strict=True)])


def _tyres(e: Ensemble) -> tuple[Array, Array]:
    """Slip and force of the mean tyre of both axles, up to near its peak, (n, k) each."""
    use = np.linspace(0.0, NEAR_PEAK, 2 * SETTINGS.rows)
    reach = e.peak * np.sqrt(e.compliance_f * e.compliance_r)
    return reach[:, None] * (inverse_forms(use) @ e.forms.T).T, e.peak[:, None] * use


def _count(grid: Array, measured: Array) -> Array:
    """How many of ``measured`` lie within one and a half rows of each row of the grid."""
    reach = 1.5 * (grid[1] - grid[0])
    ordered = np.sort(measured)
    above = np.searchsorted(ordered, grid + reach)
    below = np.searchsorted(ordered, grid - reach)
    return np.asarray(above - below, dtype=float)


def _flags(count: Array) -> Array:
    measured = count >= SETTINGS.min_count
    flags = np.full(count.size, EXTRAPOLATED)
    if measured.any():
        first, last = np.flatnonzero(measured)[[0, -1]]
        flags[first : last + 1] = INTERPOLATED
        flags[: first + 1] = INTERPOLATED  # D(1) = 0 is known
    flags[measured] = MEASURED
    return flags

r"""What a table shows of an ensemble: D(eta), f1 and f2(eta), g(slip), and g as a cubic.

    z --(pads, loads)--> F_f, F_r --tyres--> eta          D = F_f - F_r          of every draw

On a ramp the deceleration z orders everything, so z is the parameter; nothing is binned by eta.

       eta            The rising branch ends at the peak of eta. Beyond it the same eta is met
        |    __.      again at a higher z with another f1: f1 and f2 of Fig. 6 end there.
        |  /    \
        | /
        +------- z

Every draw has its D at an eta; the table has their median and the middle 95 %. Quasi-steady,
without drag, one master-cylinder pressure for both axles.
"""

import numpy as np

from calib.base.arrays import Array
from calib.car.balance import turning_shares
from calib.car.forces import paper_curves
from calib.car.tyre_forms import NEAR_PEAK, inverse_forms
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble, Shown, shown
from calib.model.parameters import RampParameters
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

_BAND = (0.5, 0.025, 0.975)
_SURE = 0.00135  # share of the draws in which eta must go on rising to doubt its peak: 3 sigma


def ridge(car: Vehicle, e: Ensemble, z: Array) -> Shown:
    """What the draws show on a ramp over ``z`` (k,) [1]."""
    return shown(car, e, e.log_pad_ratio[:, None], z * (1.0 + sum(turning_shares(car))), z)


def find_peak(of: Shown) -> tuple[float, float, bool]:
    """z and eta [1] where eta turns on a ridge, and whether it surely falls after that."""
    top = int(np.argmax(of.eta))
    falls = np.quantile(of.shift[:, top] - of.shift[:, -1], _SURE) > 0.0
    return float(of.z[top]), float(of.eta[top]), bool(falls)


def readable_up_to(of: Shown) -> float:
    """Greatest z [1] up to which eta rises steeply enough that f1 and f2 can be read from it."""
    slope = np.diff(of.eta)
    flat = np.flatnonzero(slope < SETTINGS.flat * slope[0])
    return float(of.z[flat[0]] if flat.size else of.z[-1])


def difference_curves(
    car: Vehicle, e: Ensemble, runs: list[RampRun], z_end: float
) -> tuple[DifferenceCurve, PaperCurves]:
    """D(eta) up to ``z_end`` [1], where eta grows flat, and f1, f2(eta) of Fig. 6 from it."""
    of = ridge(car, e, np.linspace(0.0, z_end, SETTINGS.rows))
    eta = np.linspace(1.0, float(of.eta[-1]), SETTINGS.rows)
    seen = [1.0 + run.since_rolling(run.blocks.eta)[run.braked] for run in runs]
    d = DifferenceCurve(*_columns(eta, differences(of, eta), seen))
    return d, paper_of(car, d, np.interp(eta, of.eta, of.z))


def paper_of(car: Vehicle, d: DifferenceCurve, z: Array) -> PaperCurves:
    """f1, f2(eta) from D(eta) at the load split of the ramp's ``z`` (k,) [1]; (18) is exact."""
    (f1, f2), (f1_lower, f2_upper), (f1_upper, f2_lower) = (
        paper_curves(car, z, D) for D in (d.D, d.lower, d.upper)
    )
    return PaperCurves(d.eta, z, f1, f1_lower, f1_upper, f2, f2_lower, f2_upper, d.count, d.flag)


def tyre_curve(e: Ensemble, of: Shown, runs: list[RampRun]) -> TyreCurve:
    """Normalised force over slip with half the weight on the axle, up to the greatest measured.

    Draws have no more force than `NEAR_PEAK` of their peak.
    """
    greatest = 1.1 * float(np.median(np.max(of.forces, axis=0)[:, -1]))
    end = np.median([np.interp(greatest, force, slip) for slip, force in _tyres(e)])
    grid = np.linspace(0.0, float(end), SETTINGS.rows)
    slips = np.median(of.slips, axis=1)
    seen = [np.interp(run.blocks.z[run.use], of.z, slip) for run in runs for slip in slips]
    return TyreCurve(*_columns(grid, tyre_forces(e, grid), seen))


def differences(of: Shown, eta: Array) -> Array:
    """D of the draws of a ridge at ``eta`` (k,) of its rising branch, (n, k) [1]."""
    rows = zip(np.maximum.accumulate(1.0 + of.shift, axis=1), np.subtract(*of.forces), strict=True)
    return np.array([np.interp(eta, x, D) for x, D in rows])


def tyre_forces(e: Ensemble, slip: Array) -> Array:
    """g of the draws at ``slip`` (k,), (n, k) [1]."""
    return np.array([np.interp(slip, x, g) for x, g in _tyres(e)])


def as_cubic(e: Ensemble, greatest: float) -> Array:
    """`RampParameters` of the draws, (8, n): slip = c F (1 + b2 F + b3 F^2), one tyre, a cubic.

    The best such curve of every draw up to the ``greatest`` force over load of the ramp [1]. The
    figures of a ramp, the mean of cars and calibration files know that tyre; estimates do not.
    """
    force = np.linspace(0.1, 1.0, 10) * greatest
    use = force / e.peak[:, None]
    x = np.einsum("nkf,nf->nk", inverse_forms(use), e.forms) / use
    bend = np.linalg.lstsq(np.column_stack([force, force**2]), (x - 1.0).T, rcond=None)[0]
    of_draws = RampParameters(
        log_compliance=0.5 * np.log(e.compliance_f * e.compliance_r),
        curvature_2=bend[0],
        curvature_3=bend[1],
        load_exponent=e.load_exponent,
        clock_offset=e.v_late,
        log_pad_ratio=e.log_pad_ratio,
        log_tyre_ratio=np.log(e.compliance_f / e.compliance_r),
        radius_load=e.radius_load,
    )
    return np.stack(of_draws)


def _tyres(e: Ensemble) -> list[tuple[Array, Array]]:
    """Slip and force (k,) of the mean tyre of both axles of each draw, up to near its peak."""
    use = np.linspace(0.0, NEAR_PEAK, 2 * SETTINGS.rows)
    reach = e.peak * np.sqrt(e.compliance_f * e.compliance_r)
    slips = reach[:, None] * (inverse_forms(use) @ e.forms.T).T
    return list(zip(slips, e.peak[:, None] * use, strict=True))


def _columns(grid: Array, draws: Array, seen: list[Array]) -> tuple[Array, ...]:
    """Grid, median and band of the ``draws`` (n, k), blocks ``seen`` near each row, and flags."""
    off = np.abs(np.concatenate(seen) - grid[:, None])
    count = np.count_nonzero(off < 1.5 * (grid[1] - grid[0]), axis=1).astype(np.float64)
    enough = count >= SETTINGS.min_count
    flags = np.full(grid.size, EXTRAPOLATED)
    flags[: np.max(np.flatnonzero(enough), initial=-1) + 1] = INTERPOLATED  # 0 at 0 is known
    flags[enough] = MEASURED
    return grid, *np.quantile(draws, _BAND, axis=0), count, flags

r"""What a table shows of an ensemble: D(eta), f1 and f2(eta), g(slip).

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
from calib.car.tyre import NEAR_PEAK, inverse_forms
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble, Shown, shown
from calib.fitting.posterior import Posterior, parts_of
from calib.model.ramp import SETTINGS, RampRun
from calib.table.budget import OWN
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
    car: Vehicle, e: Posterior, runs: list[RampRun], z_end: float
) -> tuple[DifferenceCurve, PaperCurves]:
    """D(eta) up to ``z_end`` [1], where eta grows flat, and f1, f2(eta) of Fig. 6 from it."""
    of = ridge(car, e, np.linspace(0.0, z_end, SETTINGS.rows))
    eta = np.linspace(1.0, float(of.eta[-1]), SETTINGS.rows)
    seen = [_seen(car, run, of) for run in runs]
    d = DifferenceCurve(*_columns(eta, differences(of, eta), e, seen))
    return d, paper_of(car, d, np.interp(eta, of.eta, of.z))


def _seen(car: Vehicle, run: RampRun, of: Shown) -> Array:
    """Eta [1] of the braked blocks (m,); where a motor brakes along, that of the brakes alone."""
    b, braked = run.blocks, run.braked
    if np.any(b.drive_f[braked]) or np.any(b.drive_r[braked]):
        z = run.braking[braked] / car.weight / (1.0 + sum(turning_shares(car)))
        return np.interp(z, of.z, of.eta)
    return np.asarray(1.0 + run.since_rolling(b.eta)[braked])


def paper_of(car: Vehicle, d: DifferenceCurve, z: Array) -> PaperCurves:
    """f1, f2(eta) from D(eta) at the load split of the ramp's ``z`` (k,) [1]; (18) is exact."""
    (f1, f2), (f1_lower, f2_upper), (f1_upper, f2_lower) = (
        paper_curves(car, z, D) for D in (d.D, d.lower, d.upper)
    )
    return PaperCurves(d.eta, z, f1, f1_lower, f1_upper, f2, f2_lower, f2_upper, d.count, d.flag)


def tyre_curve(e: Posterior, of: Shown, runs: list[RampRun]) -> TyreCurve:
    """Normalised force over slip with half the weight on the axle, up to the greatest measured.

    Draws have no more force than `NEAR_PEAK` of their peak.
    """
    greatest = 1.1 * float(np.median(np.max(of.forces, axis=0)[:, -1]))
    end = np.median([np.interp(greatest, force, slip) for slip, force in _tyres(e)])
    grid = np.linspace(0.0, float(end), SETTINGS.rows)
    slips = np.median(of.slips, axis=1)
    seen = [np.interp(run.blocks.z[run.use], of.z, slip) for run in runs for slip in slips]
    forces = np.array([np.interp(grid, x, g) for x, g in _tyres(e)])
    return TyreCurve(*_columns(grid, forces, e, seen))


def differences(of: Shown, eta: Array) -> Array:
    """D of the draws of a ridge at ``eta`` (k,) of its rising branch, (n, k) [1]."""
    rows = zip(np.maximum.accumulate(1.0 + of.shift, axis=1), np.subtract(*of.forces), strict=True)
    return np.array([np.interp(eta, x, D) for x, D in rows])


def _tyres(e: Ensemble) -> list[tuple[Array, Array]]:
    """Slip and force (k,) of the mean tyre of both axles of each draw, up to near its peak."""
    use = np.linspace(0.0, NEAR_PEAK, 2 * SETTINGS.rows)
    reach = e.peak * np.sqrt(e.compliance_f * e.compliance_r)
    slips = reach[:, None] * (inverse_forms(use) @ e.forms.T).T
    return list(zip(slips, e.peak[:, None] * use, strict=True))


def _columns(grid: Array, draws: Array, e: Posterior, seen: list[Array]) -> tuple[Array, ...]:
    """Grid, median and band of the ``draws`` (n, k), blocks ``seen`` near each row, flags, own."""
    off = np.abs(np.concatenate(seen) - grid[:, None])
    count = np.count_nonzero(off < 1.5 * (grid[1] - grid[0]), axis=1).astype(np.float64)
    enough = count >= SETTINGS.min_count
    flags = np.full(grid.size, EXTRAPOLATED)
    flags[: np.max(np.flatnonzero(enough), initial=-1) + 1] = INTERPOLATED  # 0 at 0 is known
    flags[enough] = MEASURED
    parts = parts_of(draws.T, e.pulls)
    whole = np.sum([*parts.values()], axis=0)
    of_run = np.sum([parts[part] for part in OWN], axis=0)
    share = np.divide(of_run, whole, out=np.zeros(grid.size), where=whole > 0.0)
    return grid, *np.quantile(draws, _BAND, axis=0), count, flags, share

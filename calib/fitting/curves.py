r"""The curves of a table, from an ensemble: D(eta), f1 and f2(eta), g(slip).

    z --(pads, loads)--> F_f, F_r --tyres--> eta          D = F_f - F_r          for every draw

On a ramp z rises with time, so z is the parameter. Nothing is binned by eta, which is noisy.

       eta            The rising branch ends at the peak of eta. Beyond it the same eta comes
        |    __.      again, at a higher z and with another f1: f1 and f2 of Fig. 6 end there.
        |  /    \
        | /
        +------- z

The table has the median and the middle 95 % of the draws. Valid for quasi-steady braking without
drag, with one master-cylinder pressure for both axles.
"""

import numpy as np

from calib.base.arrays import Array
from calib.car.balance import rotating_shares
from calib.car.forces import paper_curves
from calib.car.tyre_forms import NEAR_PEAK, inverse_forms
from calib.car.vehicle import Vehicle
from calib.fitting.ensemble import Ensemble, SlipPrediction, predict_slips
from calib.fitting.posterior import Posterior, parts_of
from calib.model.ramp import SETTINGS, RampRun
from calib.table.budget import PER_RUN
from calib.table.curves import (
    EXTRAPOLATED,
    INTERPOLATED,
    MEASURED,
    DifferenceCurve,
    PaperCurves,
    TyreCurve,
)

_BAND = (0.5, 0.025, 0.975)
_SURE = 0.00135  # a peak is sure if at most this share of the draws goes on rising: 3 sigma


def ramp_path(car: Vehicle, e: Ensemble, z: Array) -> SlipPrediction:
    """Eta and slips of the draws along a ramp, at decelerations ``z`` (k,) [1]."""
    return predict_slips(car, e, e.log_pad_ratio[:, None], z * (1.0 + sum(rotating_shares(car))), z)


def find_peak(path: SlipPrediction) -> tuple[float, float, bool]:
    """z and eta [1] at the peak of eta, and whether eta surely falls beyond it."""
    top = int(np.argmax(path.eta))
    falls = np.quantile(path.eta_rise[:, top] - path.eta_rise[:, -1], _SURE) > 0.0
    return float(path.z[top]), float(path.eta[top]), bool(falls)


def readable_up_to(path: SlipPrediction) -> float:
    """Greatest z [1] up to which eta rises steeply enough for f1(eta) and f2(eta)."""
    slope = np.diff(path.eta)
    flat = np.flatnonzero(slope < SETTINGS.flat * slope[0])
    return float(path.z[flat[0]] if flat.size else path.z[-1])


def difference_curves(
    car: Vehicle, e: Posterior, runs: list[RampRun], z_end: float
) -> tuple[DifferenceCurve, PaperCurves]:
    """D(eta) up to the deceleration ``z_end`` [1], and f1(eta), f2(eta) of Fig. 6 from it."""
    path = ramp_path(car, e, np.linspace(0.0, z_end, SETTINGS.rows))
    eta = np.linspace(1.0, float(path.eta[-1]), SETTINGS.rows)
    measured = [_measured_eta(car, run, path) for run in runs]
    d = DifferenceCurve(*_columns(eta, differences(path, eta), e, measured))
    return d, paper_of(car, d, np.interp(eta, path.eta, path.z))


def _measured_eta(car: Vehicle, run: RampRun, path: SlipPrediction) -> Array:
    """Eta [1] of the braked blocks (m,); where motors act, the eta that brakes alone would give."""
    b, braked = run.blocks, run.braked
    if np.any(b.drive_f[braked]) or np.any(b.drive_r[braked]):
        z = run.braking[braked] / car.weight / (1.0 + sum(rotating_shares(car)))
        return np.interp(z, path.z, path.eta)
    return np.asarray(1.0 + run.since_rolling(b.eta)[braked])


def paper_of(car: Vehicle, d: DifferenceCurve, z: Array) -> PaperCurves:
    """f1(eta), f2(eta) from D(eta), with the loads at ``z`` (k,) [1]; (18) holds exactly."""
    (f1, f2), (f1_lower, f2_upper), (f1_upper, f2_lower) = (
        paper_curves(car, z, D) for D in (d.D, d.lower, d.upper)
    )
    return PaperCurves(d.eta, z, f1, f1_lower, f1_upper, f2, f2_lower, f2_upper, d.count, d.flag)


def tyre_curve(e: Posterior, path: SlipPrediction, runs: list[RampRun]) -> TyreCurve:
    """Normalised force over slip with half the weight on the axle.

    Up to 1.1 times the force at the end of the ramp, and of a draw up to `NEAR_PEAK` of its peak.
    """
    greatest = 1.1 * float(np.median(np.max(path.forces, axis=0)[:, -1]))
    end = np.median([np.interp(greatest, force, slip) for slip, force in _tyres(e)])
    grid = np.linspace(0.0, float(end), SETTINGS.rows)
    slips = np.median(path.slips, axis=1)
    measured = [np.interp(run.blocks.z[run.use], path.z, slip) for run in runs for slip in slips]
    forces = np.array([np.interp(grid, x, g) for x, g in _tyres(e)])
    return TyreCurve(*_columns(grid, forces, e, measured))


def differences(path: SlipPrediction, eta: Array) -> Array:
    """D of the draws at ``eta`` (k,) on the rising branch of a path, (n, k) [1]."""
    rows = zip(
        np.maximum.accumulate(1.0 + path.eta_rise, axis=1), np.subtract(*path.forces), strict=True
    )
    return np.array([np.interp(eta, x, D) for x, D in rows])


def _tyres(e: Ensemble) -> list[tuple[Array, Array]]:
    """Slip and force (k,) of the mean tyre of both axles, by draw, up to near its peak."""
    use = np.linspace(0.0, NEAR_PEAK, 2 * SETTINGS.rows)
    reach = e.peak * np.sqrt(e.compliance_f * e.compliance_r)
    slips = reach[:, None] * (inverse_forms(use) @ e.forms.T).T
    return list(zip(slips, e.peak[:, None] * use, strict=True))


def _columns(grid: Array, draws: Array, e: Posterior, measured: list[Array]) -> tuple[Array, ...]:
    """Columns of a curve over ``grid`` (k,): median and band of ``draws`` (n, k), count, flag, own.

    The count is that of the measured blocks near each row; ``measured`` are their places.
    """
    distance = np.abs(np.concatenate(measured) - grid[:, None])
    count = np.count_nonzero(distance < 1.5 * (grid[1] - grid[0]), axis=1).astype(np.float64)
    enough = count >= SETTINGS.min_count
    flags = np.full(grid.size, EXTRAPOLATED)
    flags[: np.max(np.flatnonzero(enough), initial=-1) + 1] = INTERPOLATED  # 0 at 0 is known
    flags[enough] = MEASURED
    parts = parts_of(draws.T, e.pulls)
    whole = np.sum([*parts.values()], axis=0)
    of_run = np.sum([parts[part] for part in PER_RUN], axis=0)
    share = np.divide(of_run, whole, out=np.zeros(grid.size), where=whole > 0.0)
    return grid, *np.quantile(draws, _BAND, axis=0), count, flags, share

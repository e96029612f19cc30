r"""Make the curves of a table from an ensemble: D(eta), f1(eta) and f2(eta), g(slip).

    z --(pads, loads)--> F_f, F_r --tyres--> eta          D = F_f - F_r          for every draw

On a ramp z rises with time, so the curves have z as parameter. Nothing is binned by eta, which is
noisy.

       eta            The rising branch ends at the peak of eta. Beyond the peak the same eta comes
        |    __.      again, at a higher z and with another f1: f1 and f2 end there.
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

_BAND = (0.5, 0.025, 0.975)  # quantiles: median and the middle 95 %
_STILL_RISING = 0.00135  # largest share of draws without a peak, the tail of a normal at 3 sigma


def ramp_path(car: Vehicle, e: Ensemble, z: Array) -> SlipPrediction:
    """Predict eta and slips of the draws along a ramp, at decelerations ``z`` (k,) [1]."""
    brake = z * (1.0 + sum(rotating_shares(car)))  # force over the weight
    return predict_slips(car, e, e.log_pad_ratio[:, None], brake, z)


def find_peak(path: SlipPrediction) -> tuple[float, float, bool]:
    """Return z and eta [1] at the peak of eta, and whether nearly all draws have a peak there."""
    top = int(np.argmax(path.eta))
    falls = np.quantile(path.eta_rise[:, top] - path.eta_rise[:, -1], _STILL_RISING) > 0.0
    return float(path.z[top]), float(path.eta[top]), bool(falls)


def readable_up_to(path: SlipPrediction) -> float:
    """Return the greatest z [1] up to which eta rises steeply enough for f1(eta) and f2(eta)."""
    slope = np.diff(path.eta)
    flat = np.flatnonzero(slope < SETTINGS.flat * slope[0])
    return float(path.z[flat[0]] if flat.size else path.z[-1])


def difference_curves(
    car: Vehicle, e: Posterior, runs: list[RampRun], z_end: float
) -> tuple[DifferenceCurve, PaperCurves]:
    """Return D(eta) up to the deceleration ``z_end`` [1], and f1(eta), f2(eta) of Fig. 6."""
    path = ramp_path(car, e, np.linspace(0.0, z_end, SETTINGS.rows))
    eta = np.linspace(1.0, float(path.eta[-1]), SETTINGS.rows)
    measured = [_measured_eta(car, run, path) for run in runs]
    difference = DifferenceCurve(*_columns(eta, differences(path, eta), e, measured))
    return difference, paper_of(car, difference, np.interp(eta, path.eta, path.z))


def _measured_eta(car: Vehicle, run: RampRun, path: SlipPrediction) -> Array:
    """Return eta [1] of the braked blocks (m,).

    Where motors act it is the eta that the brakes alone would make, read from the ``path``.
    """
    b, braked = run.blocks, run.braked
    if np.any(b.drive_f[braked]) or np.any(b.drive_r[braked]):
        z = run.brake_rise[braked] / car.weight / (1.0 + sum(rotating_shares(car)))
        return np.interp(z, path.z, path.eta)
    eta_rise = b.eta - np.mean(b.eta[run.rolling])  # the lead-in shows the ratio of the radii
    return np.asarray(1.0 + eta_rise[braked])


def paper_of(car: Vehicle, d: DifferenceCurve, z: Array) -> PaperCurves:
    """Return f1(eta), f2(eta) from D(eta), with the loads at ``z`` (k,) [1].

    f1 = D F_zr/F_z and f2 = -D F_zf/F_z with F_z = F_zf + F_zr, so (18) holds exactly.
    """
    # f2 falls where D rises, so its bounds change places
    (f1, f2), (f1_lower, f2_upper), (f1_upper, f2_lower) = (
        paper_curves(car, z, D) for D in (d.D, d.lower, d.upper)
    )
    return PaperCurves(d.eta, z, f1, f1_lower, f1_upper, f2, f2_lower, f2_upper, d.count, d.flag)


def tyre_curve(e: Posterior, path: SlipPrediction, runs: list[RampRun]) -> TyreCurve:
    """Return the normalised force over slip of a tyre that carries a quarter of the weight.

    Compliance and peak of the draws are those at this load. The curve ends at 1.1 times the force
    at the end of the ramp. The force of a draw is constant beyond `NEAR_PEAK` of its peak.
    """
    last_force = 1.1 * float(np.median(np.max(path.forces, axis=0)[:, -1]))
    # slip and force of each draw's mean tyre, (n, m) each: slip = peak compliance X(force/peak),
    # where X is the inverse of a mixture of forms
    use = np.linspace(0.0, NEAR_PEAK, 2 * SETTINGS.rows)  # force over its peak
    slip_scale = e.peak * np.sqrt(e.compliance_f * e.compliance_r)
    slips = slip_scale[:, None] * (inverse_forms(use) @ e.forms.T).T
    tyres = list(zip(slips, e.peak[:, None] * use, strict=True))
    end = np.median([np.interp(last_force, force, slip) for slip, force in tyres])
    grid = np.linspace(0.0, float(end), SETTINGS.rows)
    axle_slips = np.median(path.slips, axis=1)  # (2, k)
    measured = [
        np.interp(run.blocks.z[run.use], path.z, slip) for run in runs for slip in axle_slips
    ]
    forces = np.array([np.interp(grid, slip, force) for slip, force in tyres])
    return TyreCurve(*_columns(grid, forces, e, measured))


def differences(path: SlipPrediction, eta: Array) -> Array:
    """Return D of the draws at ``eta`` (k,) on the rising branch of a path, (n, k) [1]."""
    rising = np.maximum.accumulate(1.0 + path.eta_rise, axis=1)
    D = path.forces[0] - path.forces[1]
    return np.array([np.interp(eta, x, y) for x, y in zip(rising, D, strict=True)])


def _columns(grid: Array, draws: Array, e: Posterior, measured: list[Array]) -> tuple[Array, ...]:
    """Return the columns (k,) of a curve over ``grid`` (k,), in the order of the curve's record.

    These are the grid; median, lower and upper bound of ``draws`` (n, k); the number of blocks with
    a ``measured`` value near each row; a flag; and the share of the variance that would differ on
    another run.
    """
    distance = np.abs(np.concatenate(measured) - grid[:, None])
    count = np.count_nonzero(distance < 1.5 * (grid[1] - grid[0]), axis=1).astype(np.float64)
    enough = count >= SETTINGS.min_count
    flags = np.full(grid.size, EXTRAPOLATED)
    # rows before the last measured one are interpolated, since each curve begins at a known 0
    flags[: np.max(np.flatnonzero(enough), initial=-1) + 1] = INTERPOLATED
    flags[enough] = MEASURED
    parts = parts_of(draws.T, e.pulls)
    total = np.sum([*parts.values()], axis=0)
    of_run = np.sum([parts[part] for part in PER_RUN], axis=0)
    share = np.divide(of_run, total, out=np.zeros(grid.size), where=total > 0.0)
    return grid, *np.quantile(draws, _BAND, axis=0), count, flags, share

"""Leave out the blocks of a ramp that a bump or a gear shift disturbs.

On a ramp eta and the demanded force follow the pressure smoothly. A block is disturbed where one of
them is far off its smooth course. A disturbance that passes within the ramp would bend the tyre's
curve, so its blocks take no part; one that lasts to the end of the ramp stays in.
"""

from dataclasses import replace

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.intervals import scatter
from calib.car.vehicle import Vehicle
from calib.model.ramp import SETTINGS, RampRun, nominal_forces
from calib.run.filters import true_intervals

_MOST_FITS = 100  # least squares fits of a smooth course
_CONVERGED = 1e-6  # change of its residuals, over the limit, at which a course has converged [1]


def without_disturbances(vehicle: Vehicle, run: RampRun) -> RampRun:
    """Return the ramp without its disturbed blocks, which ``left_out`` marks.

    The smooth courses over the braked blocks are linear in these terms, with the nominal brake
    force N over its largest value [1] and the time t over the length of the braking [1]:

        eta             1, N, N^2, N^3, dN/dt, t
        demanded force  1, N, N t, dN/dt
    """
    left_out = np.zeros_like(run.use)
    if np.count_nonzero(run.braked) >= SETTINGS.fewest_blocks:
        B_f, B_r = nominal_forces(vehicle, run, 0.0)
        signals = (run.blocks.end, run.blocks.eta, run.brake_sum, B_f + B_r)
        time, eta, force, nominal = (x[run.braked] for x in signals)
        N = nominal / np.max(nominal)
        t = (time - np.mean(time)) / np.ptp(time)
        rate, constant = np.gradient(N, time), np.ones_like(N)
        low, high = np.quantile(eta, [0.05, 0.95])
        eta_limit = SETTINGS.disturbance_of_eta * (high - low)
        force_limit = SETTINGS.disturbance_of_force * np.max(force)
        disturbed = _is_off([constant, N, N**2, N**3, rate, t], eta, eta_limit)
        disturbed |= _is_off([constant, N, N * t, rate], force, force_limit)
        left_out[run.braked] = _select_passing(disturbed, N)
    return replace(run, use=run.use & ~left_out, left_out=left_out)


def _is_off(terms: list[Array], y: Array, limit: float) -> Mask:
    """Whether ``y`` (n,) is off its smooth course by more than ``limit`` and its usual scatter.

    The course minimises the sum of ln(1 + (residual/scale)^2), with a third of ``limit`` as scale,
    by iteratively reweighted least squares (Holland and Welsch 1977,
    doi:10.1080/03610927708827533).
    """
    A, residual = np.column_stack(terms), np.zeros_like(y)
    for _ in range(_MOST_FITS):
        root_weight = 1.0 / np.hypot(1.0, residual / (limit / 3.0))
        last, weighted = residual, A * root_weight[:, None]
        residual = A @ np.linalg.lstsq(weighted, y * root_weight, rcond=None)[0] - y
        if np.max(np.abs(residual - last)) < _CONVERGED * limit:
            break
    return np.asarray(np.abs(residual) > max(limit, SETTINGS.disturbance_gate * scatter(residual)))


def _select_passing(disturbed: Mask, N: Array) -> Mask:
    """Select the blocks (n,) of disturbances that pass, with neighbours; none where they are many.

    A disturbance passes if there are calm blocks before it, after it, and at more nominal force
    ``N`` than it has.
    """
    size = disturbed.size
    near = np.convolve(disturbed, np.ones(4), "full")[1 : 1 + size] > 0.0  # one before, two after
    left_out, fewest = np.zeros_like(disturbed), SETTINGS.fewest_blocks // 5
    for first, end in true_intervals(near):
        at_more_force = int(np.count_nonzero(~near & (np.max(N[first:end]) < N)))
        left_out[first:end] = min(first, size - end, at_more_force) >= fewest
    return left_out & (np.mean(left_out) < SETTINGS.disturbance_share)

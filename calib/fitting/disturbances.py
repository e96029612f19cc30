"""Leave out the blocks of a ramp that a bump or a gear shift disturbs.

On a ramp, eta and the force that the deceleration demands follow the pressure smoothly. A block is
disturbed where one of the two is far off its smooth course. A temporary disturbance would bend the
tyre's curve, so its blocks are left out. One that lasts to the end of the ramp may be the course of
the tyres, so it stays in.
"""

from dataclasses import replace

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.intervals import scatter
from calib.car.vehicle import Vehicle
from calib.model.ramp import SETTINGS, RampRun, nominal_forces
from calib.run.filters import true_intervals

_MOST_FITS = 100  # largest number of least squares fits of a smooth course
_CONVERGED = 1e-6  # largest change of a residual between two fits, relative to the limit [1]


def without_disturbances(vehicle: Vehicle, run: RampRun) -> RampRun:
    """Return the ramp without its disturbed blocks, and mark them in ``left_out``.

    The smooth courses over the braked blocks are sums of these terms with free factors. N is the
    nominal brake force over its largest value [1], t the time over the length of the braking [1].

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
        left_out[run.braked] = _temporary(disturbed, N)
    return replace(run, use=run.use & ~left_out, left_out=left_out)


def _is_off(terms: list[Array], y: Array, limit: float) -> Mask:
    """Whether ``y`` (n,) is off its smooth course, by more than ``limit`` and its usual scatter.

    The course minimises the sum of ln(1 + (residual/scale)^2), where the scale is a third of
    ``limit``, by iteratively reweighted least squares (Holland and Welsch 1977,
    doi:10.1080/03610927708827533).
    """
    A, residual = np.column_stack(terms), np.zeros_like(y)
    for _ in range(_MOST_FITS):
        root_weight = 1.0 / np.hypot(1.0, residual / (limit / 3.0))
        last, weighted = residual, A * root_weight[:, None]
        residual = A @ np.linalg.lstsq(weighted, y * root_weight, rcond=None)[0] - y
        if np.max(np.abs(residual - last)) < _CONVERGED * limit:
            break
    usual = SETTINGS.disturbance_gate * scatter(residual)
    return np.asarray(np.abs(residual) > max(limit, usual))


def _temporary(disturbed: Mask, N: Array) -> Mask:
    """Whether a block (n,) is of a temporary disturbance, or next to one.

    A disturbance is temporary if enough blocks lie before and after it, and enough undisturbed
    blocks have a larger nominal force ``N`` than any of its own. If such blocks are a large share
    of the ramp, none is marked.
    """
    size, fewest = disturbed.size, SETTINGS.fewest_blocks // 5
    left_out = np.zeros_like(disturbed)
    # a disturbance also covers one block before it and two after it
    near = np.convolve(disturbed, np.ones(4), "full")[1 : 1 + size] > 0.0
    for first, end in true_intervals(near):
        at_more_force = int(np.count_nonzero(~near & (np.max(N[first:end]) < N)))
        left_out[first:end] = min(first, size - end, at_more_force) >= fewest
    return left_out & (np.mean(left_out) < SETTINGS.disturbance_share)

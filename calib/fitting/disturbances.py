"""Blocks of a ramp in which something else acts for a moment: a bump, a gear shift, a patch.

    eta             ~ 1, N, N^2, N^3, dN/dt, t       over the blocks that are braked, without
    demanded force  ~ 1, N, N t, dN/dt               what stands out; N: force of nominal pads

On a ramp both follow the pressure smoothly, whatever tyres and pads are. What stands out from that
and comes back to it, at pressures that the ramp goes beyond, is left out of the fit: some blocks
that are 50 sigma off bend the tyre's curve, and that is taken for other pads. What lasts to the end
stays in: nobody knows which part is the usual one.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.car.vehicle import Vehicle
from calib.model.ramp import RampRun, nominal_forces
from calib.model.settings import SETTINGS

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def without_disturbances(vehicle: Vehicle, run: RampRun) -> RampRun:
    """The ramp without the blocks that show a disturbance; ``left_out`` says which they are."""
    left_out = disturbed(vehicle, run)
    return replace(run, use=run.use & ~left_out, left_out=left_out)


def disturbed(vehicle: Vehicle, run: RampRun) -> Mask:
    """Blocks (k,) of a ramp that show a disturbance which comes and goes."""
    b, inside = run.blocks, run.braked
    none = np.zeros_like(inside)
    if np.count_nonzero(inside) < SETTINGS.fewest_blocks:
        return none
    B_f, B_r = nominal_forces(vehicle, run, 0.0)
    time, eta, force, N = (x[inside] for x in (b.end, b.eta, run.brake_sum, B_f + B_r))
    N = N / np.max(N)
    t = (time - np.mean(time)) / np.ptp(time)
    rate, one = np.gradient(N, time), np.ones_like(N)
    usual_eta = np.column_stack([one, N, N**2, N**3, rate, t])
    usual_force = np.column_stack([one, N, N * t, rate])
    spread = float(np.subtract(*np.quantile(eta, [0.95, 0.05])))
    wild = _off(usual_eta, eta, SETTINGS.disturbance_of_eta * spread)
    wild |= _off(usual_force, force, SETTINGS.disturbance_of_force * float(np.max(force)))
    none[inside] = _passing(wild, N)
    return none


def _off(A: Array, y: Array, least: float) -> Mask:
    """Where ``y`` (n,) is far off its smooth course: by ``least``, and by its usual scatter."""
    from scipy.optimize import least_squares
    from scipy.stats import median_abs_deviation

    first = np.linalg.lstsq(A, y, rcond=None)[0]
    smooth = least_squares(
        lambda x: A @ x - y, first, jac=lambda _: A, loss="cauchy", f_scale=least / 3.0
    )
    rest = y - A @ smooth.x
    scatter = float(median_abs_deviation(rest, scale="normal"))
    return np.asarray(np.abs(rest) > max(least, SETTINGS.disturbance_gate * scatter))


def _passing(wild: Mask, N: Array) -> Mask:
    """Of the ``wild`` blocks (n,) the groups that end, with what rings on; none if they are many.

    A group ends where the run is calm before it, after it, and at more force than it had.
    """
    near = np.convolve(wild, np.ones(4), "full")[1 : 1 + wild.size] > 0.0  # one before, two after
    edges = np.flatnonzero(np.diff(np.concatenate([[0], near, [0]])))
    left_out = np.zeros_like(wild)
    for first, end in zip(edges[::2], edges[1::2], strict=True):
        calm = min(first, wild.size - end) >= SETTINGS.fewest_blocks // 5
        beyond = np.count_nonzero(~near & (np.max(N[first:end]) < N))
        if calm and beyond >= SETTINGS.fewest_blocks // 5:
            left_out[first:end] = True
    return left_out if np.mean(left_out) < SETTINGS.disturbance_share else np.zeros_like(wild)

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

from calib.base.arrays import Array, Mask
from calib.base.intervals import QUARTILE
from calib.car.vehicle import Vehicle
from calib.model.ramp import SETTINGS, RampRun, nominal_forces
from calib.run.filters import runs as runs_of


def without_disturbances(vehicle: Vehicle, run: RampRun) -> RampRun:
    """The ramp without the blocks that show a disturbance; ``left_out`` says which they are."""
    left_out = np.zeros_like(run.use)
    if np.count_nonzero(run.braked) >= SETTINGS.fewest_blocks:
        nominal = np.add(*nominal_forces(vehicle, run, 0.0))
        of_run = (run.blocks.end, run.blocks.eta, run.brake_sum, nominal)
        time, eta, force, N = (x[run.braked] for x in of_run)
        N = N / np.max(N)
        t, rate, one = (time - np.mean(time)) / np.ptp(time), np.gradient(N, time), np.ones_like(N)
        spread = np.subtract(*np.quantile(eta, [0.95, 0.05]))
        wild = _off([one, N, N**2, N**3, rate, t], eta, SETTINGS.disturbance_of_eta * spread)
        wild |= _off([one, N, N * t, rate], force, SETTINGS.disturbance_of_force * np.max(force))
        left_out[run.braked] = _passing(wild, N)
    return replace(run, use=run.use & ~left_out, left_out=left_out)


def _off(terms: list[Array], y: Array, least: float) -> Mask:
    """Where ``y`` (n,) is far off its smooth course: by ``least``, and by its usual scatter."""
    from scipy.optimize import least_squares

    A = np.column_stack(terms)
    start = np.linalg.lstsq(A, y, rcond=None)[0]
    smooth = least_squares(lambda x: A @ x - y, start, loss="cauchy", f_scale=least / 3.0)
    rest = np.abs(A @ smooth.x - y)
    scatter = np.median(rest) / QUARTILE
    return np.asarray(rest > max(least, SETTINGS.disturbance_gate * scatter))


def _passing(wild: Mask, N: Array) -> Mask:
    """Of the ``wild`` blocks (n,) the groups that end, with what rings on; none if they are many.

    A group ends where the run is calm before it, after it, and at more force than it had.
    """
    near = np.convolve(wild, np.ones(4), "full")[1 : 1 + wild.size] > 0.0  # one before, two after
    left_out, few = np.zeros_like(wild), SETTINGS.fewest_blocks // 5
    for first, end in runs_of(near):
        beyond = int(np.count_nonzero(~near & (np.max(N[first:end]) < N)))
        left_out[first:end] = min(first, wild.size - end, beyond) >= few
    return left_out & (np.mean(left_out) < SETTINGS.disturbance_share)

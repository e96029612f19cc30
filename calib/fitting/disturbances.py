"""Blocks of a ramp that a bump or a gear shift disturbs, by its smooth course."""

from dataclasses import replace

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.intervals import scatter
from calib.car.vehicle import Vehicle
from calib.model.ramp import SETTINGS, RampRun, nominal_forces
from calib.run.filters import true_intervals

_MOST, _STAYS = 100, 1e-6
"""Most least squares of a smooth course, and change over the least disturbance at which it ends."""


def without_disturbances(vehicle: Vehicle, run: RampRun) -> RampRun:
    """The ramp without the blocks of a bump or a gear shift, which ``left_out`` marks.

        eta             ~ 1, N, N^2, N^3, dN/dt, t     over the braked blocks, N nominal force
        demanded force  ~ 1, N, N t, dN/dt

    Both follow the pressure smoothly. A deviation that passes within the ramp would bend the tyre's
    curve; one that lasts to the end stays in.
    """
    left_out = np.zeros_like(run.use)
    if np.count_nonzero(run.braked) >= SETTINGS.fewest_blocks:
        nominal = np.add(*nominal_forces(vehicle, run, 0.0))
        of_run = (run.blocks.end, run.blocks.eta, run.brake_sum, nominal)
        time, eta, force, N = (x[run.braked] for x in of_run)
        N = N / np.max(N)
        t = (time - np.mean(time)) / np.ptp(time)
        rate, constant = np.gradient(N, time), np.ones_like(N)
        spread = np.subtract(*np.quantile(eta, [0.95, 0.05]))
        wild = _off([constant, N, N**2, N**3, rate, t], eta, SETTINGS.disturbance_of_eta * spread)
        least = SETTINGS.disturbance_of_force * np.max(force)
        wild |= _off([constant, N, N * t, rate], force, least)
        left_out[run.braked] = _passing(wild, N)
    return replace(run, use=run.use & ~left_out, left_out=left_out)


def _off(terms: list[Array], y: Array, least: float) -> Mask:
    """Where ``y`` (n,) is off its smooth course by more than ``least`` and its usual scatter.

    The course has the least sum of ln(1 + (residual/scale)^2), by least squares that are weighed
    anew until they stay (Holland and Welsch 1977, doi:10.1080/03610927708827533).
    """
    A, residual = np.column_stack(terms), np.zeros_like(y)
    for _ in range(_MOST):
        root = 1.0 / np.hypot(1.0, residual / (least / 3.0))
        last, course = residual, np.linalg.lstsq(A * root[:, None], y * root, rcond=None)[0]
        residual = A @ course - y
        if np.max(np.abs(residual - last)) < _STAYS * least:
            break
    return np.asarray(np.abs(residual) > max(least, SETTINGS.disturbance_gate * scatter(residual)))


def _passing(wild: Mask, N: Array) -> Mask:
    """Groups of ``wild`` blocks (n,) that pass, with their neighbours; none where they are many.

    A group passes if the run is calm before it, after it, and at more force than it had.
    """
    near = np.convolve(wild, np.ones(4), "full")[1 : 1 + wild.size] > 0.0  # one before, two after
    left_out, few = np.zeros_like(wild), SETTINGS.fewest_blocks // 5
    for first, end in true_intervals(near):
        beyond = int(np.count_nonzero(~near & (np.max(N[first:end]) < N)))
        left_out[first:end] = min(first, wild.size - end, beyond) >= few
    return left_out & (np.mean(left_out) < SETTINGS.disturbance_share)

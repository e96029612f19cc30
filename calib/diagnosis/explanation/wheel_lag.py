"""Lag of the force F of a tyre behind the torque T on the wheel, by the inertia J of the wheel.

    wheel   J omega' = R F - T
    tyre    sigma/v ds'/dt + s' = 1 - R omega/v      F = F_z K s'

    tau sigma/v F'' + tau F' + F = u                 tau = J v/(R^2 F_z K)

u is the force at which the wheel is in balance, sigma the relaxation length, s' the slip of the
contact patch, K the slope of the tyre curve at that slip. The wheel swings at
R sqrt(F_z K/(J sigma))/(2 pi), 20 to 40 Hz, the less damped the slower the car. Without a
relaxation length the force follows with the time constant tau of 2 to 10 ms. Source: Pacejka, Tyre
and Vehicle Dynamics, 3rd ed., ch. 7 and 8. The coefficients count as constant over a step.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from calib.base.arrays import Array
from calib.car.braking import MOVING

_SHORTEST = 1e-3  # relaxation length [m] that counts as none: far stiffer than any tyre
_LEAST = 1e-6  # least time constant [s], and least difference of two roots [1/steps]


@dataclass(frozen=True)
class WheelLag:
    """The motion of k wheels over each step of a clock.

    The input u is a parabola through three samples: a disc turns by up to 1 rad in a step, and
    straight lines would lose a twentieth of its ripple.
    """

    relaxation_time: Array  # sigma/v [s] (n,)
    step: float  # h [s]
    banded: Array  # recursion of F, h F' sample by sample, in lower banded storage (4, 2 k n)
    taps: Array  # weights of the last three inputs in F and in h F', (2, 3, k, n - 1)

    @classmethod
    def from_tau(cls, time_constant: Array, relaxation: float, v: Array, step: float) -> Self:
        """Build the lag from tau [s] (k, n), ``relaxation`` length [m], ``v`` (n,) and step [s]."""
        relaxation_time = max(relaxation, _SHORTEST) / np.maximum(v, MOVING)
        tau_steps = np.maximum(time_constant, _LEAST)[:, 1:] / step
        relaxation_steps = relaxation_time[1:] / step
        free = _free_motion(tau_steps, relaxation_steps)
        banded = np.zeros((*time_constant.shape, 2, 4))
        # the next F and h F' stand 2 and 3 rows below F, so 1 and 2 rows below h F'
        for j in range(2):
            banded[:, :-1, j, 2 - j : 4 - j] = -np.moveaxis(free[:, j], 0, -1)
        taps = _taps(tau_steps, relaxation_steps, free)
        return cls(relaxation_time, step, banded.reshape(-1, 4).T, taps)

    def follow(self, balance: Array) -> tuple[Array, Array]:
        """Force [N] and rate [N/s] for ``balance`` u [N], from steady state; (..., k, n)."""
        from scipy.linalg.lapack import dtbtrs

        u, u_next = balance[..., :-1], balance[..., 1:]
        # the input before the first sample lies on the straight line through the first two
        u_previous = np.concatenate([2.0 * u[..., :1] - u_next[..., :1], u[..., :-1]], axis=-1)
        right = np.zeros((*balance.shape, 2))
        right[..., 0, 0] = balance[..., 0]
        for i, (tap_previous, tap, tap_next) in enumerate(self.taps):
            right[..., 1:, i] = tap_previous * u_previous + tap * u + tap_next * u_next
        columns = right.reshape(-1, self.banded.shape[1]).T
        out = dtbtrs(self.banded, columns, uplo="L", diag="U", overwrite_b=1)[0].T
        force, rate = np.moveaxis(out.reshape(right.shape), -1, 0)
        return force.copy(), rate / self.step


def _free_motion(tau: Array, relaxation: Array) -> Array:
    """Transition e^A (2, 2, k, m) of (F, F') over a step without an input; times in steps.

    A = [[0, 1], [-1/(tau relaxation), -1/relaxation]] has the eigenvalues mean +- root.
    """
    mean = -0.5 / relaxation
    root = np.sqrt(mean**2 - 1.0 / (tau * relaxation) + 0.0j)  # imaginary where the wheel swings
    root = np.where(root == 0.0, _LEAST, root)
    slow, fast = np.exp(mean + root), np.exp(mean - root)
    even, odd = 0.5 * (slow + fast).real, (0.5 * (slow - fast) / root).real
    # e^A = even I + odd (A - mean I)
    return np.array([[even - odd * mean, odd], [-odd / (tau * relaxation), even + odd * mean]])


def _taps(tau: Array, relaxation: Array, free: Array) -> Array:
    """Weights of three inputs in F and F' at the end of a step (2, 3, k, m); times in steps.

    The inputs stand one step before the step, at its begin and at its end. For the parabola
    u = level + slope t + bend t^2/2 through them, the motion settles to
    u - tau u' + tau (tau - relaxation) u''; until then the free motion is added.
    """
    # rows: level, slope and bend at the begin; columns: for an input of 1 alone at each place
    parabolas = np.array([[0.0, 1.0, 0.0], [-0.5, 0.0, 0.5], [1.0, -2.0, 1.0]])
    level, slope, bend = parabolas[:, :, None, None]
    # settled F and F' at the begin of the step, and at its end, where t = 1
    force, rate = level - tau * slope + tau * (tau - relaxation) * bend, slope - tau * bend
    at_end = np.array([force + rate + 0.5 * bend, rate + bend])
    return np.asarray(at_end - np.einsum("ij...,jk...->ik...", free, np.array([force, rate])))

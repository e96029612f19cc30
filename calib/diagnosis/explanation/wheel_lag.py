"""How the force of a tyre follows that in balance: the inertia of the wheel on the tyre's spring.

    tau sigma/v F'' + tau F' + F = u      tau = J v/(R^2 F_z K)

Wheel: J omega' = R F - T. Tyre: sigma/v ds'/dt + s' = 1 - R omega/v and F = F_z K s'. Here u is the
force at which the wheel is in balance, and sigma the relaxation length. The wheel swings at
R sqrt(F_z K/(J sigma)), 20 to 40 Hz, the less damped the slower the car; without a relaxation
length it follows with the time constant tau of 2 to 10 ms. Source: Pacejka, Tyre and Vehicle
Dynamics, 3rd ed., ch. 7 and 8. K is the slope of the tyre at the slip that it has.
"""

from dataclasses import dataclass
from typing import Self

import numpy as np

from calib.base.arrays import Array
from calib.car.braking import MOVING

_SHORTEST = 1e-3  # relaxation length [m] that counts as none: far stiffer than any tyre
_LEAST = 1e-6  # least time constant [s]; root of two alike, in steps [1]


@dataclass(frozen=True)
class WheelLag:
    """The motion of some wheels over each step of a clock, if coefficients hardly change over one.

    Exact for an input that is a parabola through a sample, the one before and the one after. A disc
    turns by up to 1 rad in a step: straight lines between samples would take a twentieth of its
    ripple.

    ``way`` sigma/v [s] (n,); ``step`` h [s]; ``band`` (4, 2 k n) the lower triangle of the
    recursion over forces F and rates h F' by turns, of k wheels; ``taps`` (2, 3, k, n - 1) what the
    last three inputs add to each of both.
    """

    way: Array
    step: float
    band: Array
    taps: Array

    @classmethod
    def from_tau(cls, time_constant: Array, relaxation: float, v: Array, step: float) -> Self:
        """From tau [s] (k, n), the relaxation length [m], speed [m/s] (n,) and step [s]."""
        way = max(relaxation, _SHORTEST) / np.maximum(v, MOVING)
        times = np.maximum(time_constant, _LEAST)[:, 1:] / step, way[1:] / step
        free = _free(*times)
        band = np.zeros((*time_constant.shape, 2, 4))
        for j in range(2):  # from F, and from h F'
            band[:, :-1, j, 2 - j : 4 - j] = -np.moveaxis(free[:, j], 0, -1)
        return cls(way, step, band.reshape(-1, 4).T, _taps(*times, free))

    def follow(self, balance: Array) -> tuple[Array, Array]:
        """Force [N] and rate [N/s] for that in ``balance`` [N], where it starts; (..., k, n)."""
        from scipy.linalg.lapack import dtbtrs

        u, u_next = balance[..., :-1], balance[..., 1:]
        u_last = np.concatenate([2.0 * u[..., :1] - u_next[..., :1], u[..., :-1]], axis=-1)
        right = np.zeros((*balance.shape, 2))
        right[..., 0, 0] = balance[..., 0]
        for row, (old, middle, new) in enumerate(self.taps):
            right[..., 1:, row] = old * u_last + middle * u + new * u_next
        columns = right.reshape(-1, self.band.shape[1]).T
        out = dtbtrs(self.band, columns, uplo="L", diag="U", overwrite_b=1)[0].T
        force, rate = np.moveaxis(out.reshape(right.shape), -1, 0)
        return force.copy(), rate / self.step


def _free(tau: Array, way: Array) -> Array:
    """e^A (2, 2, k, m) of F and F' over a step without an input; times in steps.

    A = [[0, 1], [-1/(tau way), -1/way]], its roots mean + root and mean - root.
    """
    mean = -0.5 / way
    root = np.sqrt(mean**2 - 1.0 / (tau * way) + 0.0j)  # imaginary where the wheel swings
    root = np.where(root == 0.0, _LEAST, root)
    slow, fast = np.exp(mean + root), np.exp(mean - root)
    even, odd = 0.5 * (slow + fast).real, (0.5 * (slow - fast) / root).real
    return np.array([[even - odd * mean, odd], [-odd / (tau * way), even + odd * mean]])


def _taps(tau: Array, way: Array, free: Array) -> Array:
    """What an input of 1 before, in the middle and after a step adds to F and F', times in steps.

    For u = level + slope t + bend t^2/2 the motion settles to u - tau u' + tau (tau - way) u''.
    """
    each = np.array([[0.0, 1.0, 0.0], [-0.5, 0.0, 0.5], [1.0, -2.0, 1.0]])
    level, slope, bend = each[:, :, None, None]
    force, rate = level - tau * slope + tau * (tau - way) * bend, slope - tau * bend
    ended = np.array([force + rate + 0.5 * bend, rate + bend])
    return np.asarray(ended - np.einsum("ij...,jk...->ik...", free, np.array([force, rate])))

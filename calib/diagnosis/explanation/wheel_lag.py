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
from numpy.typing import NDArray

from calib.car.braking import MOVING

Array = NDArray[np.float64]

SHORTEST = 1e-3
"""Relaxation length [m] that counts as none: its spring is far stiffer than any tyre."""

LEAST = 1e-6
"""Least time constant [s], and least root in steps [1]."""


@dataclass(frozen=True)
class WheelLag:
    """The motion over each step of a clock, for coefficients that hardly change over one.

    Exact for an input that is a parabola through a sample, the one before and the one after. A disc
    turns by up to 1 rad in a step: straight lines between samples would take a twentieth of its
    ripple.

    ``way`` sigma/v [s] (n,); ``step`` h [s]; ``band`` (4, 2 n) the lower triangle of the recursion
    over forces F and rates h F' by turns; ``taps`` (2, 3, n - 1) what the last three inputs add to
    each of both.
    """

    way: Array
    step: float
    band: Array
    taps: Array

    @classmethod
    def of(cls, time_constant: Array, relaxation: float, v: Array, step: float) -> Self:
        """From tau [s] (n,), the relaxation length [m], speed [m/s] (n,) and step [s]."""
        h, tau = step, np.maximum(time_constant, LEAST)
        way = max(relaxation, SHORTEST) / np.maximum(v, MOVING)
        stay, drive, pull, slow = _free(tau[1:] / h, way[1:] / h)
        band = np.empty((4, 2 * tau.size), order="F")
        band[:, -2:] = 0.0
        band[2, 0:-2:2], band[2, 1:-2:2] = -stay, -slow
        band[1, 0:-2:2], band[1, 1:-2:2] = 0.0, -drive
        band[3, 0:-2:2], band[3, 1:-2:2] = -pull, 0.0
        return cls(way, h, band, _taps(tau[1:] / h, way[1:] / h, (stay, drive, pull, slow)))

    def follow(self, balance: Array) -> tuple[Array, Array]:
        """Force [N] and its rate [N/s] (n,) for the force in ``balance`` [N] (n,).

        It starts in balance.
        """
        from scipy.linalg.lapack import dtbtrs

        before = np.concatenate([2.0 * balance[:1] - balance[1:2], balance[:-2]])
        right = np.empty((2 * balance.size, 1))
        right[:2, 0] = balance[0], 0.0
        for row, (old, middle, new) in enumerate(self.taps):
            right[2 + row :: 2, 0] = old * before + middle * balance[:-1] + new * balance[1:]
        out, _ = dtbtrs(self.band, right, uplo="L", diag="U", overwrite_b=1)
        return out[0::2, 0].copy(), out[1::2, 0] / self.step


_Elements = tuple[Array, Array, Array, Array]


def _free(tau: Array, way: Array) -> _Elements:
    """_Elements of e^A of a step without an input, times in steps: stay, drive, pull and slow.

    F <- stay F + drive F', F' <- pull F + slow F'.
    """
    mean = -0.5 / way
    square = mean**2 - 1.0 / (tau * way)  # negative where the wheel swings
    root = np.maximum(np.sqrt(np.abs(square)), LEAST)
    even, odd = np.empty_like(root), np.empty_like(root)
    s = square < 0.0
    swing = np.exp(mean[s])
    even[s], odd[s] = swing * np.cos(root[s]), swing * np.sin(root[s])
    s = ~s
    one, other = np.exp(np.minimum(mean[s] + root[s], 0.0)), np.exp(mean[s] - root[s])
    even[s], odd[s] = 0.5 * (one + other), 0.5 * (one - other)
    odd /= root
    return even - odd * mean, odd, -odd / (tau * way), even + odd * mean


def _taps(tau: Array, way: Array, elements: _Elements) -> Array:
    """What an input of 1 before, in the middle and after a step adds to F and F', times in steps.

    For u = level + slope t + bend t^2/2 the motion settles to u - tau u' + tau (tau - way) u''.
    """
    stay, drive, pull, slow = elements
    rest = tau * (tau - way)
    by_level = np.array([1.0 - stay, -pull])
    by_slope = np.array([1.0 - tau + stay * tau - drive, 1.0 + pull * tau - slow])
    by_bend = np.array(
        [0.5 - tau + rest - stay * rest + drive * tau, 1.0 - tau - pull * rest + slow * tau]
    )
    half = 0.5 * by_slope
    return np.stack([by_bend - half, by_level - 2.0 * by_bend, by_bend + half], axis=1)

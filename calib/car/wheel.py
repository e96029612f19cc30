"""One wheel over a whole run: the slip at which tyre, brake and inertia are in balance.

    F_x:  (J_w d omega/dt + T_b + M)/R  =  F_z F(lambda),   omega = v (1 - lambda)/R       (1) (21)

d omega/dt is the difference to the sample before (backward Euler), so a step in pressure causes no
numerical oscillation at any sampling rate. One Newton step for all samples is a bidiagonal system.
The left side falls with slip and the right side rises, so it always has a solution.
"""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.base.names import G
from calib.car import forces
from calib.car.magic_formula import MagicFormula
from calib.car.vehicle import Axle

_EDGE = 0.999
"""End of the rising branch, as in `MagicFormula.slip_at`. The force there is within 2e-6 of the
peak and the slope is still positive, so the equations can be solved."""


@dataclass(frozen=True)
class WheelDemand:
    """Torques and load of a wheel; arrays (n,).

    ``torque`` of the brake, ``moment`` of all other causes that slow it [N m]; ``load`` F_z [N].
    """

    torque: Array
    moment: Array
    load: Array


@dataclass(frozen=True)
class Travel:
    """Motion of the car; arrays (n,): ``time`` [s], ``v`` [m/s] above zero, ``z`` [1]."""

    time: Array
    v: Array
    z: Array


@dataclass(frozen=True)
class RisingTyre:
    """A tyre at the load of every sample, continued linearly beyond the end of its rising branch.

    The continuation helps the solver; a result with ``used`` above 1 is not valid.
    """

    tyre: MagicFormula
    relative_load: Array

    @property
    def edge(self) -> Array:
        """Slip [1] at the end of the rising branch (n,)."""
        return self.tyre.slip_at(_EDGE, self.relative_load)

    def used(self, slip: Array) -> Array:
        """Slip over that at the end of the rising branch [1]; above 1 it is beyond the peak."""
        return np.abs(slip) / self.edge

    def force(self, slip: Array) -> Array:
        """Normalised force [1]."""
        held = np.clip(slip, -self.edge, self.edge)
        beyond = (slip - held) * self.tyre.slope(self.edge, self.relative_load)
        return self.tyre.force(held, self.relative_load) + beyond

    def slope(self, slip: Array) -> Array:
        """Slope d force/d slip [1], above zero everywhere."""
        return self.tyre.slope(np.clip(slip, -self.edge, self.edge), self.relative_load)


def spin_rate(axle: Axle, travel: Travel, slip: Array) -> Array:
    """Spin rate d omega/dt [rad/s^2] (n,) since the sample before; the first at constant slip."""
    omega = forces.wheel_speed(axle, slip, travel.v)
    first = -G * travel.z[0] * omega[0] / travel.v[0]
    return np.concatenate([[first], np.diff(omega) / np.diff(travel.time)])


def tyre_force(axle: Axle, demand: WheelDemand, travel: Travel, slip: Array) -> Array:
    """Tyre force [N] (n,) from the motion of the wheel, (1)."""
    return forces.tyre_force(axle, demand.torque, spin_rate(axle, travel, slip), demand.moment)


def next_slip(
    axle: Axle, tyre: RisingTyre, demand: WheelDemand, travel: Travel, slip: Array
) -> Array:
    """One Newton step from ``slip`` [1] (n,) towards the slip that solves (1) in all samples."""
    from scipy.linalg.lapack import dtbtrs

    residual = tyre_force(axle, demand, travel, slip) - demand.load * tyre.force(slip)
    # d(J_w/R d omega/dt)/d lambda: omega = v (1 - lambda)/R enters its own sample and the next.
    inertia = axle.wheel_inertia / axle.rolling_radius**2 * travel.v
    step = np.diff(travel.time)
    bands = np.zeros((2, slip.size))
    bands[0] = demand.load * tyre.slope(slip)
    bands[0, 1:] += inertia[1:] / step
    bands[1, :-1] = -inertia[:-1] / step
    change, info = dtbtrs(bands, residual[:, None], uplo="L")
    if info:
        raise ArithmeticError(f"no slip solves sample {info - 1}")
    return np.asarray(slip + change[:, 0])

"""Baselines of the pad friction: the paper's law, and the methods that it compares itself with.

The curves f1(eta), f2(eta) hold on the road of the ramp. A method that does not apply gives NaN.

    y = J d omega/dt - (z + f1) R F_z + mu_n C P = -zeta C P     (23), front; f2 at the rear
    y = theta u,   theta = zeta,   u = -C P                      (24)

(25) as printed lacks the derivative: it is d theta_hat/dt = gamma eps u, eps = y - theta_hat u. In
steps of dt it is stable while gamma u^2 dt < 2. A Lyapunov function is
(theta - theta_hat)^2/(2 gamma); that of the paper, (26) to (28), is one for constant u only.
"""

from collections.abc import Callable

import numpy as np

from calib.base.arrays import Array
from calib.car.balance import ForceBalance
from calib.car.effects.effect import Pair
from calib.car.vehicle import Axle
from calib.estimation.estimator import Estimate
from calib.run.filters import recursive_filter
from calib.table.table import Table

RATE, PRESSURE = 8.0, 20e5
"""Rate of the gradient law [1/s] at a usual braking pressure [Pa]: 90 % of a step of zeta in 0.3 s.
It grows with the square of the pressure."""
_MEMORY = 0.5  # of the mean gain [s]: short against a stop, long against road noise (0.1 s)


def nominal(e: Estimate, factor: Array | float = 1.0) -> Pair:
    """The nominal pads, times a factor."""
    factor = factor * np.ones_like(e.read.time)
    return e.car.front.pad_friction * factor, e.car.rear.pad_friction * factor


def mean_gain(e: Estimate) -> Pair:
    """Nominal pads times one factor, the paper's [16].

    Recursive least squares of demanded on nominal brake force, forgetting over `_MEMORY`; 1 before
    the first braking. Of [16] the paper only says that its gain is recursive and rests on the
    deceleration: here a_x without known resistance. It cannot tell the axles apart.
    """
    u = np.where(e.forces.active, e.forces.nominal_f + e.forces.nominal_r, 0.0)
    pole = [1.0, -float(np.exp(-e.read.sample_time / _MEMORY))]
    numerator, denominator = (
        recursive_filter(x, pole) for x in (u * e.forces.balance.demanded, u * u)
    )
    factor = np.divide(numerator, denominator, out=np.ones_like(u), where=denominator > 0.0)
    return nominal(e, factor)


# The paper's law ---------------------------------------------------------------------------------


def _adapted(e: Estimate) -> Pair:
    """Pad friction mu_n + zeta of the axles (n,) by the law on the brake forces of the curves.

    Each axle has its own gain, and is frozen where no pads bite.
    """
    brakes = _by_curves(e.table, e.eta, e.forces.balance)

    def adapt(axle: Axle, p: Array, brake: Array) -> Array:
        torque = axle.torque_gain * p
        y = axle.pad_friction * torque - 0.5 * axle.rolling_radius * brake  # (23)
        u = np.where(e.forces.active, -torque, 0.0)  # (24)
        return axle.pad_friction + gradient(y, u, gain(axle), e.read.sample_time)

    return adapt(e.car.front, e.read.p_f, brakes[0]), adapt(e.car.rear, e.read.p_r, brakes[1])


def _by_curves(table: Table, eta: Array, b: ForceBalance) -> Pair:
    """Brake forces [N] of tyres at z + f1(eta) and z + f2(eta), (11)-(14), as exported.

    ``eta`` zeroed (22) (n,); z the sum of the tyre forces of ``b`` over the weight. Beyond the ends
    of the curves their last values.
    """
    c, z = table.paper, b.tyre_sum / table.vehicle.weight
    F_f, F_r = (z + np.interp(eta, c.eta, f) for f in (c.f1, c.f2))
    return F_f * b.load_f - b.drag_f, F_r * b.load_r - b.drag_r


def gain(axle: Axle) -> float:
    """gamma [1/(N^2 m^2 s)] that adapts this axle at `RATE` at `PRESSURE`."""
    return RATE / (axle.torque_gain * PRESSURE) ** 2


def gradient(y: Array, u: Array, gamma: float, dt: float) -> Array:
    """theta after each sample by (25), from 0, (n,); NaN where gamma u^2 dt reaches 2: unstable.

    theta[k+1] = (1 - gamma u^2 dt) theta[k] + gamma dt u y is a lower bidiagonal system.
    """
    from scipy.linalg import solve_banded

    step = gamma * dt * u
    if np.max(step * u, initial=0.0) >= 2.0:
        return np.full_like(y, np.nan)
    band = np.stack([np.ones_like(u), np.append((step * u)[1:], 2.0) - 1.0])
    return np.asarray(solve_banded((1, 0), band, step * y))  # (25)


METHODS: dict[str, Callable[[Estimate], Pair]] = {
    "nominal": nominal,
    "mean_gain": mean_gain,
    "gradient_paper": _adapted,
}
"""The methods by the names that they have in files."""

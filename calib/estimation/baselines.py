"""Other methods for the pad friction: nominal pads, a mean gain, and the law of the paper.

A method that does not apply gives NaN. The law adapts the change zeta of the pad friction of each
axle from its nominal value mu_n. It takes the force of the axle from the curves f1(eta), f2(eta) of
the table, which hold on the road of the ramp. Of a wheel, J is the inertia, R the radius, F_z the
load, and C the torque per pressure P and pad friction:

    y = J d omega/dt - (z + f1) R F_z + mu_n C P = -zeta C P     (23), front; f2 at the rear
    y = theta u,   theta = zeta,   u = -C P                      (24)

    d theta_hat/dt = gamma eps u,   eps = y - theta_hat u                 (25)

(25) as printed lacks the derivative. In steps of dt it is stable while gamma u^2 dt < 2. A Lyapunov
function is (theta - theta_hat)^2/(2 gamma); that of the paper, (26) to (28), holds for constant u
only.
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
"""Rate of the law [1/s] at a usual braking pressure [Pa]: 90 % of a step of zeta in 0.3 s. The rate
grows with the square of the pressure."""
_MEMORY = 0.5  # time over which the mean gain forgets [s]: a stop is longer, road noise is shorter


def nominal(e: Estimate, factor: Array | float = 1.0) -> Pair:
    """Return the nominal pad friction of both axles (n,), times a factor."""
    factor = factor * np.ones_like(e.signals.time)
    return e.car.front.pad_friction * factor, e.car.rear.pad_friction * factor


def mean_gain(e: Estimate) -> Pair:
    """Return the nominal pads times one factor for both axles, reference [16] of the paper.

    The factor is the recursive least squares solution of demanded over nominal brake force, which
    forgets over `_MEMORY`, and 1 before the first braking. The paper says no more than that the
    gain is recursive and rests on the deceleration; here known resistance is taken out of a_x.
    """
    u = np.where(e.forces.active, e.forces.nominal_f + e.forces.nominal_r, 0.0)
    pole = [1.0, -float(np.exp(-e.signals.sample_time / _MEMORY))]
    numerator, denominator = (
        recursive_filter(x, pole) for x in (u * e.forces.balance.demanded, u * u)
    )
    factor = np.divide(numerator, denominator, out=np.ones_like(u), where=denominator > 0.0)
    return nominal(e, factor)


def _adapted(e: Estimate) -> Pair:
    """Return the pad friction mu_n + zeta of both axles (n,); zeta stays where no pads bite."""
    brakes = _by_curves(e.table, e.eta, e.forces.balance)

    def adapt(axle: Axle, p: Array, brake: Array) -> Array:
        """Return the pad friction (n,) of an axle with pressure ``p`` [Pa], ``brake`` force [N]."""
        CP = axle.torque_gain * p
        # (23): the brake force has (z + f1) F_z - (J d omega/dt)/R of both wheels
        y = axle.pad_friction * CP - 0.5 * axle.rolling_radius * brake
        u = np.where(e.forces.active, -CP, 0.0)  # (24)
        return axle.pad_friction + gradient(y, u, gain(axle), e.signals.sample_time)

    return adapt(e.car.front, e.signals.p_f, brakes[0]), adapt(e.car.rear, e.signals.p_r, brakes[1])


def _by_curves(table: Table, eta: Array, b: ForceBalance) -> Pair:
    """Return brake forces [N] of both axles by the normalised forces z + f1 and z + f2, (11)-(14).

    ``eta`` (22) is over its zero (n,). z is the sum of the tyre forces of ``b`` over the weight.
    Beyond its end a curve keeps its last value.
    """
    c, z = table.paper, b.tyre_sum / table.vehicle.weight
    F_f, F_r = (z + np.interp(eta, c.eta, f) for f in (c.f1, c.f2))
    return F_f * b.load_f - b.drag_f, F_r * b.load_r - b.drag_r


def gain(axle: Axle) -> float:
    """Return gamma [1/(N^2 m^2 s)] at which (25) adapts an axle with `RATE` at `PRESSURE`."""
    return RATE / (axle.torque_gain * PRESSURE) ** 2


def gradient(y: Array, u: Array, gamma: float, dt: float) -> Array:
    """Return theta_hat (n,) by (25), from 0, or NaN where (25) is unstable in steps of dt."""
    from scipy.linalg import solve_banded

    step = gamma * dt * u
    if np.max(step * u, initial=0.0) >= 2.0:
        return np.full_like(y, np.nan)
    # theta[k] - (1 - gamma dt u^2) theta[k-1] = gamma dt u y is a lower bidiagonal system, (25)
    # rows of ``band``: the diagonal, and the numbers below it, of which the last is not used
    band = np.stack([np.ones_like(u), np.append((step * u)[1:] - 1.0, 0.0)])
    return np.asarray(solve_banded((1, 0), band, step * y))


METHODS: dict[str, Callable[[Estimate], Pair]] = {
    "nominal": nominal,
    "mean_gain": mean_gain,
    "gradient_paper": _adapted,
}
"""The methods by the names that they have in files."""

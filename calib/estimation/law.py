"""The paper's law (23)-(28), and the normalised forces that it takes for known.

    y = J d omega/dt - F_bar R F_z + mu_n C P = -zeta C P        (23)
    y = theta u,   theta = zeta,   u = -C P                      (24)

(25) as printed lacks the dot and the sampling time; it is theta_dot = gamma eps u. In steps of dt
it is stable while gamma u^2 dt < 2. The Lyapunov function that decreases is theta_err^2/(2 gamma):
(26) takes eps = -theta_err u in place of theta_err, so that (27), (28) hold for constant u only.
"""

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.errors import InputError
from calib.car.balance import ForceBalance
from calib.car.bias import front_share
from calib.car.effects.effect import Pair
from calib.car.vehicle import Axle
from calib.estimation.constants import Reader
from calib.table.table import Table

RATE, PRESSURE = 8.0, 20e5
"""Rate of the gradient law [1/s], 90 % of a step of zeta in 0.3 s, at a pressure [Pa] of a usual
braking; it grows with its square."""


def by_curves(table: Table, eta: Array, level: Array) -> Pair:
    """F_f = level + f1(eta), F_r = level + f2(eta) [1], (11), (12), as the table exports them.

    ``eta`` zeroed (22), ``level`` z, both (n,). Beyond the ends of the curves their last values.
    """
    c = table.paper
    return level + np.interp(eta, c.eta, c.f1), level + np.interp(eta, c.eta, c.f2)


def by_map(table: Table, eta: Array, b: ForceBalance) -> Pair:
    """F_f, F_r [1] that share the demanded brake force as the map of the table says, without v.

    With the loads of the live deceleration they are z + f1(z, eta) and z + f2(z, eta): together
    they are all tyre forces, so (18) holds exactly. ``eta`` zeroed (22) (n,). Beyond the ends of
    the map its last values.
    """
    assert table.map is not None
    ratios = Reader(table.map, ("ratio",))
    braked = np.clip(b.demanded / table.vehicle.weight, *ratios.axes[0][[0, -1]])
    (ratio,) = ratios(braked, (eta - 1.0) / braked, np.zeros_like(eta))
    share = front_share(table.vehicle, ratio)
    F_f = (share * b.demanded + b.moment_f) / b.load_f
    return F_f, ((1.0 - share) * b.demanded + b.moment_r) / b.load_r


def adapted(
    axle: Axle, pressure: Array, road: Array, gamma: float, dt: float, acts: Mask | bool = True
) -> Array:
    """Pad friction mu_n + zeta of an axle [1] (n,).

    ``road`` the force that its brakes must have [N] (n,), F_bar F_z of both wheels less what else
    slows them, inertia included; ``gamma`` as `gain`; ``dt`` [s]; frozen where not ``acts``. Raises
    InputError if the law is unstable: too high a pressure for the rate of the log.
    """
    torque = axle.torque_gain * pressure
    y = axle.pad_friction * torque - 0.5 * axle.rolling_radius * road  # (23)
    u = np.where(acts, -torque, 0.0)  # (24)
    return axle.pad_friction + gradient(y, u, gamma, dt)


def gain(axle: Axle) -> float:
    """gamma [1/(N^2 m^2 s)] that adapts this axle at `RATE` at `PRESSURE`."""
    return RATE / (axle.torque_gain * PRESSURE) ** 2


def gradient(y: Array, u: Array, gamma: float, dt: float) -> Array:
    """theta after each sample by (25), from 0, (n,). Raises InputError if gamma u^2 dt reaches 2.

    theta[k+1] = (1 - gamma u^2 dt) theta[k] + gamma dt u y is a lower bidiagonal system, so LAPACK
    solves it in one call.
    """
    from scipy.linalg.lapack import dtbtrs

    step = gamma * dt
    worst = step * float(np.max(u * u, initial=0.0))
    if worst >= 2.0:
        raise InputError(
            f"the adaptive law is unstable: gamma u^2 dt = {worst:.2f}",
            expected="below 2",
            do="lower the gain, or log faster",
        )
    band = np.ones((2, u.size), order="F")  # unit diagonal and one below it
    band[1, :-1] = step * u[1:] * u[1:] - 1.0
    theta, info = dtbtrs(band, (step * u * y)[:, None], uplo="L", diag="U", overwrite_b=1)
    assert info == 0
    return np.asarray(theta[:, 0])  # (25)

"""The paper's adaptive law (23)-(28), and recursive least squares, on one axle.

    y = J d omega/dt - F_bar R F_z + mu_n C P = -zeta C P        (23)
    y = theta u,   theta = zeta,   u = -C P                      (24)

(25) as printed lacks the dot and the sampling time; it is theta_dot = gamma eps u. In steps of dt
it is stable while gamma u^2 dt < 2. The Lyapunov function that decreases is theta_err^2/(2 gamma):
(26) takes eps = -theta_err u in place of theta_err, so that (27), (28) hold for constant u only.
theta moves only while u is not 0; it is frozen below a pressure.

The recursion theta[k+1] = (1 - gamma u^2 dt) theta[k] + gamma dt u y is a lower bidiagonal system,
so LAPACK solves it in one call.
"""

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import InputError
from calib.car.vehicle import Axle

Array = NDArray[np.float64]

RATE = 8.0
"""Rate of the gradient law at `PRESSURE` [1/s]: 90 % of a step of zeta in 0.3 s."""

PRESSURE = 20e5
"""Pressure [Pa] at which it holds: a usual braking. The rate grows with its square."""

MEMORY = 1.0
"""Forgetting of the recursive least squares [s]: shorter, and eta's noise shows in the pads."""

LEVEL_MEMORY = 0.5
"""The same of a gain for both axles [s]: short against a stop, long against road noise (0.1 s)."""


def measured_output(
    axle: Axle, force: Array, load: Array, spin: Array, pressure: Array, moment: Array | float
) -> Array:
    """Output y of (23) of one wheel [N m], what else slows the wheel (``moment``) taken out.

    It is (13) or (14) with all that is known on one side. ``force`` normalised force F_bar [1];
    ``load`` of the wheel [N]; ``spin`` d omega/dt [rad/s^2].
    """
    return (
        axle.wheel_inertia * spin
        - force * axle.rolling_radius * load
        + axle.pad_friction * axle.torque_gain * pressure
        + moment
    )  # (23)


def regressor(axle: Axle, pressure: Array) -> Array:
    """u = -C P of (24) for one wheel [N m]."""
    return -axle.torque_gain * pressure  # (24)


def gain(axle: Axle, rate: float = RATE, pressure: float = PRESSURE) -> float:
    """gamma [1/(N^2 m^2 s)] that adapts at ``rate`` [1/s] at ``pressure`` [Pa] on this axle."""
    return rate / (axle.torque_gain * pressure) ** 2


def gradient(y: Array, u: Array, gamma: float, dt: float, start: float = 0.0) -> Array:
    """theta after each sample by (25), (n,). Raises InputError if gamma u^2 dt reaches 2.

    ``u`` is zero where the law is frozen.
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
    n = u.size
    # theta[k] - (1 - gamma dt u^2) theta[k-1] = gamma dt u y: unit diagonal and one below it
    band = np.empty((2, n), order="F")
    band[0] = 1.0
    band[1, : n - 1] = step * u[1:] * u[1:] - 1.0
    band[1, n - 1] = 0.0
    right = step * u * y
    right[0] += (1.0 - step * u[0] * u[0]) * start
    theta, info = dtbtrs(band, right[:, None], uplo="L", diag="U", overwrite_b=1)
    assert info == 0
    return np.asarray(theta[:, 0])  # (25)


def least_squares(y: Array, u: Array, memory: float, dt: float, prior: float = 0.0) -> Array:
    """theta by recursive least squares with forgetting over ``memory`` [s], (n,).

    ``prior`` [N^2 m^2] is a weight of theta = 0 that is never forgotten: it draws theta to zero
    where u is small. Without it theta is zero until u first moves, and held after u has ended.
    """
    from scipy.signal import lfilter

    pole = [1.0, -float(np.exp(-dt / memory))]
    above = lfilter([1.0], pole, u * y)
    below = lfilter([1.0], pole, u * u) + prior
    return np.asarray(np.divide(above, below, out=np.zeros_like(above), where=below > 0.0))

"""The paper's law against a plain loop, the exponential, its limit; its forces against (18)."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.balance import force_balance
from calib.car.effects.effects import Effects
from calib.estimation import baselines as law
from tests.support.tables import VEHICLE, C, K, made_table

DT = 0.005
AXLE = VEHICLE.front
GAIN = 2.0 * 28.84e-4 * 0.1309
"""C of Table I with two pad faces [m^3]."""


def run(n=400, seed=1, theta=-0.15):
    """u over a wavering braking, and y = theta u with noise."""
    rng = np.random.default_rng(seed)
    u = -GAIN * 20e5 * (1.0 + 0.5 * np.sin(np.arange(n) / 30.0))
    return theta * u + 0.05 * np.abs(u) * rng.normal(size=n), u


def plain_loop(y, u, gamma, dt):
    theta, out = 0.0, []
    for k in range(y.size):
        theta = theta + gamma * (y[k] - theta * u[k]) * u[k] * dt  # forward Euler of (25)
        out.append(theta)
    return np.array(out)


# (23), (24) --------------------------------------------------------------------------------------


def test_gain_adapts_both_axles_at_the_same_rate():
    for axle in (VEHICLE.front, VEHICLE.rear):
        assert law.gain(axle) * (axle.torque_gain * 20e5) ** 2 == pytest.approx(8.0)


# (25) --------------------------------------------------------------------------------------------


@pytest.mark.parametrize("n", [1, 400])
def test_gradient_is_the_plain_loop(n):
    y, u = run(n)
    gamma = law.gain(AXLE)
    expected = plain_loop(y, u, gamma, DT)
    assert law.gradient(y, u, gamma, DT) == pytest.approx(expected, rel=1e-13, abs=1e-13)


def test_constant_u_gives_the_exponential():
    """theta = theta* (1 - exp(-gamma u^2 t)); Euler's steps err by half a step in the rate."""
    rate, dt = 8.0, 1e-5
    u = np.full(100_000, -GAIN * 20e5)
    theta = law.gradient(-0.15 * u, u, rate / u[0] ** 2, dt)
    t = dt * np.arange(1, u.size + 1)
    assert theta == pytest.approx(-0.15 * (1.0 - np.exp(-rate * t)), abs=0.15 * rate * dt)


def test_stable_just_below_the_limit_and_not_known_at_it():
    u = np.full(4000, -700.0)
    below, above = 1.99 / (700.0**2 * DT), 2.0001 / (700.0**2 * DT)
    theta = law.gradient(-0.1 * u, u, below, DT)
    assert np.max(np.abs(theta[-100:] + 0.1)) < 1e-12  # |1 - 1.99|^4000
    grown = plain_loop(-0.1 * u, u, 1.05 * above, DT)
    assert np.abs(grown[-1]) > 1e3
    assert np.isnan(law.gradient(-0.1 * u, u, above, DT)).all()


def test_lyapunov_rate_is_the_slope_of_the_function():
    """dV/dt = -eps^2 of V = theta_err^2/(2 gamma), also while u changes, where (27) and (28) as
    printed do not hold."""
    dt = 1e-6
    u = -GAIN * 20e5 * (1.0 + np.linspace(0.0, 0.5, 1000))
    gamma = law.gain(AXLE)
    error = law.gradient(-0.15 * u, u, gamma, dt) + 0.15
    slope = np.diff(error**2 / (2.0 * gamma)) / dt
    eps = -error[:-1] * u[1:]
    assert slope == pytest.approx(-(eps**2), rel=1e-4)


# Forces ------------------------------------------------------------------------------------------


def forces(brakes, b):
    """F_x/F_z of the axles that brake so, by the balance of their moments."""
    return (brakes[0] + b.drag_f) / b.load_f, (brakes[1] + b.drag_r) / b.load_r


def balance(z, tyres=None):
    """At 20 m/s, of a car that the ``tyres`` slow by this share of its weight alone."""
    b = force_balance(VEHICLE, Effects(), z, 20.0 + 0.0 * z, z, z)
    return b if tyres is None else replace(b, tyre_sum=VEHICLE.weight * tyres)


def test_curves_give_the_straight_tyre_and_the_level():
    """D = C (eta - 1) at z = K (eta - 1); known effects shift the level and not the difference."""
    eta = 1.0 + np.linspace(1e-4, 0.0045, 30)
    z = K * (eta - 1.0)
    b = balance(z, z - 0.02)
    F_f, F_r = forces(law._by_curves(made_table(rows=41), eta, b), b)
    assert F_f - F_r == pytest.approx(C * (eta - 1.0), rel=0.012)
    front = (1.6494 + 0.615 * z) / 2.805
    assert front * F_f + (1.0 - front) * F_r == pytest.approx(z - 0.02, abs=1.5e-6)  # (18)

"""The adaptive law against a plain loop, the exponential, its stability limit; RLS against LSQ."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.errors import InputError
from calib.car import forces
from calib.estimation import adaptive
from tests.support.tables import VEHICLE

DT = 0.005
AXLE = VEHICLE.front


def run(n=400, seed=1, theta=-0.15):
    """u over a wavering braking, and y = theta u with noise."""
    rng = np.random.default_rng(seed)
    pressure = 20e5 * (1.0 + 0.5 * np.sin(np.arange(n) / 30.0))
    u = adaptive.regressor(AXLE, pressure)
    return theta * u + 0.05 * np.abs(u) * rng.normal(size=n), u


def plain_loop(y, u, gamma, dt, start):
    theta, out = start, []
    for k in range(y.size):
        theta = theta + gamma * (y[k] - theta * u[k]) * u[k] * dt  # forward Euler of (25)
        out.append(theta)
    return np.array(out)


# (23), (24) --------------------------------------------------------------------------------------


@given(st.floats(-0.3, 0.3), st.floats(1e5, 1e7), st.floats(0.0, 1.2), st.floats(0.0, 50.0))
def test_output_over_regressor_is_the_departure_of_the_pad(zeta, pressure, F, moment):
    """A wheel that turns by (13) with mu_n + zeta; (23), (24) give the zeta back."""
    load = np.asarray(5000.0)
    torque = forces.brake_torque(AXLE, AXLE.pad_friction + zeta, pressure)
    spin = (AXLE.rolling_radius * F * load - torque - moment) / AXLE.wheel_inertia
    y = adaptive.measured_output(AXLE, np.asarray(F), load, spin, np.asarray(pressure), moment)
    assert y / adaptive.regressor(AXLE, pressure) == pytest.approx(zeta, abs=1e-8)


def test_gain_adapts_both_axles_at_the_same_rate():
    for axle in (VEHICLE.front, VEHICLE.rear):
        u = adaptive.regressor(axle, 20e5)
        assert adaptive.gain(axle, 8.0, 20e5) * u**2 == pytest.approx(8.0)


# (25) --------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("n", "start"), [(1, 0.0), (400, -0.3)])
def test_gradient_is_the_plain_loop(n, start):
    y, u = run(n)
    gamma = adaptive.gain(AXLE)
    expected = plain_loop(y, u, gamma, DT, start)
    assert adaptive.gradient(y, u, gamma, DT, start) == pytest.approx(
        expected, rel=1e-13, abs=1e-13
    )


def test_constant_u_gives_the_exponential():
    """theta = theta* (1 - exp(-gamma u^2 t)); Euler's steps err by half a step in the rate."""
    rate, dt = 8.0, 1e-5
    u = np.full(100_000, adaptive.regressor(AXLE, 20e5))
    theta = adaptive.gradient(-0.15 * u, u, adaptive.gain(AXLE, rate), dt)
    t = dt * np.arange(1, u.size + 1)
    assert theta == pytest.approx(-0.15 * (1.0 - np.exp(-rate * t)), abs=0.15 * rate * dt)


def test_stable_just_below_the_limit_and_refused_at_it():
    u = np.full(4000, -700.0)
    below, above = 1.99 / (700.0**2 * DT), 2.0001 / (700.0**2 * DT)
    theta = adaptive.gradient(-0.1 * u, u, below, DT)
    assert np.max(np.abs(theta[-100:] + 0.1)) < 1e-12  # |1 - 1.99|^4000
    grown = plain_loop(-0.1 * u, u, 1.05 * above, DT, 0.0)
    assert np.abs(grown[-1]) > 1e3
    with pytest.raises(InputError, match=r"unstable: gamma u\^2 dt = 2\.00.*below 2"):
        adaptive.gradient(-0.1 * u, u, above, DT)


# (26) to (28) ------------------------------------------------------------------------------------


def lyapunov(theta_error, gamma):
    """V = theta_err^2/(2 gamma) [N^2 m^2 s], the honest form of (26)."""
    return theta_error**2 / (2.0 * gamma)


# Recursive least squares -------------------------------------------------------------------------


@pytest.mark.parametrize(("k", "prior"), [(0, 3e6), (57, 0.0), (399, 3e6)])
def test_least_squares_is_the_direct_weighted_solve(k, prior):
    y, u = run()
    memory = 0.4
    root = np.exp(-0.5 * DT / memory * np.arange(k, -1, -1))
    A = np.append(root * u[: k + 1], np.sqrt(prior))[:, None]
    b = np.append(root * y[: k + 1], 0.0)
    expected = np.linalg.lstsq(A, b, rcond=None)[0][0]
    assert adaptive.least_squares(y, u, memory, DT, prior)[k] == pytest.approx(expected, rel=1e-9)


def test_lyapunov_rate_is_the_slope_of_the_function():
    """dV/dt = -eps^2, also while u changes, where (27) and (28) as printed do not hold."""
    dt = 1e-6
    u = adaptive.regressor(AXLE, 20e5 * (1.0 + np.linspace(0.0, 0.5, 1000)))
    gamma = adaptive.gain(AXLE)
    error = adaptive.gradient(-0.15 * u, u, gamma, dt) + 0.15
    slope = np.diff(lyapunov(error, gamma)) / dt
    eps = -error[:-1] * u[1:]
    assert slope == pytest.approx(-(eps**2), rel=1e-4)

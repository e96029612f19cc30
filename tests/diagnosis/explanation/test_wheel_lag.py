"""The lag of a wheel against closed forms and an integrator."""

import numpy as np
import pytest
from scipy.integrate import solve_ivp

from calib.diagnosis.explanation.wheel_lag import WheelLag

STEP = 0.01


def followed(tau: float, relaxation: float, v: float, balance: np.ndarray) -> np.ndarray:
    """Force and rate (2, n) of one wheel."""
    size = balance.size
    lag = WheelLag.from_tau(np.full((1, size), tau), relaxation, np.full(size, v), STEP)
    return np.concatenate(lag.follow(balance[None]))


@pytest.mark.parametrize("tau", [1e-4, 0.004, 0.01])
def test_a_wheel_on_a_stiff_tyre_keeps_the_ripple_of_a_disc(tau):
    """Against 1/(1 + j w T): 14 turns a second, 0.9 rad in a step of 10 ms."""
    t, w = STEP * np.arange(400), 90.0
    exact = np.exp(1j * w * t) / (1.0 + 1j * w * tau)
    force = followed(tau, 0.0, 30.0, np.sin(w * t))[0, 50:]
    amplitude = 2.0 * np.mean(force * np.exp(-1j * w * t[50:]))
    assert abs(amplitude) == pytest.approx(np.abs(exact[0]), rel=0.03)


@pytest.mark.parametrize(
    ("tau", "relaxation", "v"),
    [(0.03, 0.0, 20.0), (0.0027, 0.38, 30.0), (0.00036, 0.38, 4.0), (0.01, 0.05, 20.0)],
)
def test_force_and_rate_are_those_of_an_integrator(tau, relaxation, v):
    t, way = STEP * np.arange(200), max(relaxation, 1e-3) / v

    def balance(now):
        return np.sin(7.0 * now) * np.clip(now, 0.0, 1.0)

    def rate(now, y):
        return [y[1], (balance(now) - y[0] - tau * y[1]) / (tau * way)]

    expected = solve_ivp(rate, (0.0, t[-1]), [0.0, 0.0], "LSODA", t_eval=t, rtol=1e-9, atol=1e-12).y
    force, change = followed(tau, relaxation, v, balance(t))
    assert force == pytest.approx(expected[0], abs=1e-3)
    assert change == pytest.approx(expected[1], abs=0.2)  # of 7 a second


def test_a_released_wheel_swings_on_its_tyre():
    """R sqrt(F_z K/(J sigma)) over 2 pi, damped by v/(2 sigma): 1.1 kg m^2, 4 kN, 0.3 m."""
    inertia, load, stiffness, radius, sigma, v = 1.1, 4000.0, 30.0, 0.3, 0.4, 8.0
    tau = inertia * v / (radius**2 * load * stiffness)
    t = STEP * np.arange(60)
    force = followed(tau, sigma, v, np.where(t < 0.1, 1.0, 0.0))[0]
    natural = radius * np.sqrt(load * stiffness / (inertia * sigma))
    free = t > 0.15  # the step of the input is a ramp of two samples here
    turns = np.exp((-0.5 * v / sigma + 1j * np.sqrt(natural**2 - (0.5 * v / sigma) ** 2)) * t[free])
    A = np.stack([turns.real, turns.imag], axis=1)
    fitted = A @ np.linalg.lstsq(A, force[free], rcond=None)[0]
    assert force[free] == pytest.approx(fitted, abs=1e-6)
    assert np.max(np.abs(force[free])) > 0.1

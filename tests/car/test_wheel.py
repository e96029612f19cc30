"""One wheel: Newton's result against the closed inverse, and the tyre made monotone."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.car.magic_formula import MagicFormula
from calib.car.vehicle import Axle
from calib.car.wheel import RisingTyre, Travel, WheelDemand, next_slip, tyre_force

TYRE = MagicFormula(25.0, 0.9, load_exponent=0.1)
TIME = np.arange(200) / 200.0


def axle(inertia):
    return Axle(0.322, inertia, 28.84e-4, 0.1309, 2, 0.38)


def settled(wheel, tyre, demand, travel):
    slip = np.zeros(TIME.size)
    for _ in range(40):
        slip = next_slip(wheel, tyre, demand, travel, slip)
    return slip


@given(st.floats(0.05, 0.98), st.floats(0.6, 1.4))
def test_without_inertia_the_slip_is_the_closed_inverse(share, load):
    force = share * TYRE.peak * np.linspace(0.0, 1.0, TIME.size)
    tyre = RisingTyre(TYRE, np.full(TIME.size, load))
    carried = np.full(TIME.size, 4000.0)
    demand = WheelDemand(0.322 * force * 4000.0, 0.0 * TIME, carried)
    travel = Travel(TIME, np.full(TIME.size, 20.0), 0.0 * TIME)
    slip = settled(axle(0.0), tyre, demand, travel)
    assert slip == pytest.approx(TYRE.rising(force, load)[0], rel=1e-9, abs=1e-12)


def test_a_step_reaches_the_tyre_with_the_time_constant_of_wheel_and_tyre():
    """Linear tyre: tau = J v/(R^2 F_z K); after one time constant 63 % of the force is there."""
    wheel, load, v = axle(1.2), 4000.0, 20.0
    stiff = MagicFormula(25.0, 1e4)
    tau = 1.2 * v / (0.322**2 * load * 25.0)
    time = np.arange(4000) / 4000 * 20 * tau
    n = time.size
    torque = np.where(time > 0.0, 100.0, 0.0)
    demand = WheelDemand(torque, np.zeros(n), np.full(n, load))
    travel = Travel(time, np.full(n, v), np.zeros(n))
    tyre = RisingTyre(stiff, np.ones(n))
    slip = np.zeros(n)
    for _ in range(5):
        slip = next_slip(wheel, tyre, demand, travel, slip)
    expected = 100.0 / 0.322 * (1.0 - np.exp(-time / tau))
    assert load * tyre.force(slip) == pytest.approx(expected, abs=0.005 * 100.0 / 0.322)


def test_equation_1_holds_once_settled():
    rng = np.random.default_rng(1)
    wheel, tyre = axle(1.2), RisingTyre(TYRE, np.ones(TIME.size))
    torque = 500.0 + 30.0 * rng.standard_normal(TIME.size)
    demand = WheelDemand(torque, np.full(TIME.size, 14.0), np.full(TIME.size, 4200.0))
    z = np.full(TIME.size, 0.4)
    travel = Travel(TIME, 30.0 - 9.80665 * 0.4 * TIME, z)
    slip = settled(wheel, tyre, demand, travel)
    assert tyre_force(wheel, demand, travel, slip) == pytest.approx(
        4200.0 * tyre.force(slip), abs=1e-7
    )


def test_beyond_the_edge_the_force_goes_on_rising_without_a_step():
    tyre = RisingTyre(TYRE, np.ones(1))
    edge = float(tyre.edge[0])
    around = np.array([edge * (1 - 1e-9), edge * (1 + 1e-9)])
    low, high = RisingTyre(TYRE, np.ones(2)).force(around)
    assert high == pytest.approx(low, abs=1e-9)
    far = RisingTyre(TYRE, np.ones(50)).force(np.linspace(-3.0 * edge, 3.0 * edge, 50))
    assert np.all(np.diff(far) > 0.0)
    assert tyre.used(np.array([1.01 * edge]))[0] > 1.0
    assert TYRE.peak - TYRE.force(np.array([edge]))[0] < 2e-6 * TYRE.peak

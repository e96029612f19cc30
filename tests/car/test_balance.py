"""The balance of forces against figures worked out by hand."""

import math

import numpy as np
import pytest

from calib.base.names import G
from calib.car.balance import brake_forces, force_balance, moment_at_road
from calib.car.effects.effects import Effects
from tests.support.reference_car import CAR


def test_brake_forces_are_2_per_axle():
    p = np.array([0.0, 50e5])
    front, rear = brake_forces(CAR, p, p)
    # Table I at 50 bar: two wheels, two pad faces, at the radius of the wheel
    assert front[1] == pytest.approx(2 * 2 * 0.38 * 28.84e-4 * 0.1309 * 50e5 / 0.322)
    assert rear[1] == pytest.approx(2 * 2 * 0.38 * 11.34e-4 * 0.1240 * 50e5 / 0.322)
    assert front[0] == rear[0] == 0.0
    f, r = brake_forces(CAR, p, p, math.log(1.21))
    assert f[1] / front[1] == pytest.approx(1.1)
    assert r[1] / rear[1] == pytest.approx(1.0 / 1.1)


def test_inertia_drives_on_what_the_moment_slows():
    # two wheels of 1.2 kg m^2 that slow by 20 rad/s^2 give 48 N m back, at 0.322 m
    axle = CAR.front
    free = moment_at_road(axle, 0.0, np.array([-20.0]))
    assert free == pytest.approx(-2.0 * axle.wheel_inertia * 20.0 / axle.rolling_radius)
    assert moment_at_road(axle, 100.0, np.array([0.0])) == pytest.approx(100.0 / 0.322)


def test_without_effects_the_brakes_carry_weight_and_wheels():
    z, one = np.array([0.0, 0.4]), np.ones(2)
    balance = force_balance(CAR, Effects(), np.array([0.0, 0.1]), 20.0 * one, z, 0.0 * one)
    wheels = sum(2.0 * a.wheel_inertia / a.rolling_radius**2 for a in (CAR.front, CAR.rear))
    assert balance.demanded == pytest.approx((CAR.mass + wheels) * G * z)
    assert balance.load_f + balance.load_r == pytest.approx(CAR.weight * one)


def test_drag_slows_the_body_and_rolling_the_wheels():
    effects = Effects(
        {
            "aerodynamic_drag": {"drag_area": 0.7},
            "rolling_resistance": {"coefficient": 0.01},
        }
    )
    z, one = np.array([0.0, 0.0]), np.ones(2)
    balance = force_balance(CAR, effects, np.array([0.0, 0.1]), 20.0 * one, z, 0.0 * one)
    assert balance.moment_f + balance.moment_r == pytest.approx(0.01 * CAR.weight * one)
    assert balance.tyre_sum == pytest.approx(-balance.body)
    assert balance.demanded == pytest.approx(-balance.body - 0.01 * CAR.weight)


def test_a_motor_takes_its_part_from_the_brakes_of_its_axle():
    z, one = np.array([0.3, 0.3]), np.ones(2)
    motion = (np.array([0.0, 0.1]), 20.0 * one, z, 0.0 * one)
    free = force_balance(CAR, Effects(), *motion)
    driven = force_balance(CAR, Effects(), *motion, drive=(-300.0 * one, 80.0 * one))
    # 300 N m slow at the front, 80 N m drive at the rear, both at 0.322 m
    assert driven.other_f == pytest.approx(300.0 / 0.322 * one)
    assert driven.moment_f - free.moment_f == pytest.approx(300.0 / 0.322 * one)
    assert driven.moment_r - free.moment_r == pytest.approx(-80.0 / 0.322 * one)
    assert free.demanded - driven.demanded == pytest.approx(220.0 / 0.322 * one)
    assert driven.tyre_sum == pytest.approx(free.tyre_sum)

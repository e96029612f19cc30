"""The balance of forces against figures worked out by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import G
from calib.car.balance import (
    brake_forces,
    force_balance,
    front_biased_up_to,
    front_share,
    lock_efficiency,
    pressure_per_g,
)
from calib.car.effects.effects import Effects
from calib.car.forces import axle_loads
from calib.car.vehicle import Vehicle
from tests.support.reference_car import CAR
from tests.support.tables import VEHICLE


def test_brake_forces_follow_equation_2_for_both_wheels():
    p = np.array([0.0, 50e5])
    front, rear = brake_forces(CAR, p, p)
    # Table I at 50 bar: two wheels, two pad faces, at the radius of the wheel
    assert front[1] == pytest.approx(2 * 2 * 0.38 * 28.84e-4 * 0.1309 * 50e5 / 0.322)
    assert rear[1] == pytest.approx(2 * 2 * 0.38 * 11.34e-4 * 0.1240 * 50e5 / 0.322)
    assert front[0] == rear[0] == 0.0
    f, r = brake_forces(CAR, p, p, math.log(1.21))
    assert f[1] / front[1] == pytest.approx(1.1)
    assert r[1] / rear[1] == pytest.approx(1.0 / 1.1)


def test_without_effects_the_brakes_carry_weight_and_wheels():
    z, ones = np.array([0.0, 0.4]), np.ones(2)
    balance = force_balance(CAR, Effects(), np.array([0.0, 0.1]), 20.0 * ones, z, 0.0 * ones)
    wheels = sum(2.0 * a.wheel_inertia / a.rolling_radius**2 for a in (CAR.front, CAR.rear))
    assert balance.demanded == pytest.approx((CAR.mass + wheels) * G * z)
    assert balance.load_f + balance.load_r == pytest.approx(CAR.weight * ones)


def test_a_motor_takes_its_part_from_the_brakes_of_its_axle():
    z, ones = np.array([0.3, 0.3]), np.ones(2)
    motion = (np.array([0.0, 0.1]), 20.0 * ones, z, 0.0 * ones)
    free = force_balance(CAR, Effects(), *motion)
    driven = force_balance(CAR, Effects(), *motion, drive=(-300.0 * ones, 80.0 * ones))
    # 300 N m slow at the front, 80 N m drive at the rear, both at 0.322 m
    assert driven.drag_no_inertia_f == pytest.approx(300.0 / 0.322 * ones)
    assert driven.drag_f - free.drag_f == pytest.approx(300.0 / 0.322 * ones)
    assert driven.drag_r - free.drag_r == pytest.approx(-80.0 / 0.322 * ones)
    assert free.demanded - driven.demanded == pytest.approx(220.0 / 0.322 * ones)
    assert driven.tyre_sum == pytest.approx(free.tyre_sum)


MU = 0.8


def friction_used(car: Vehicle, z: float) -> tuple[float, float]:
    """Force over load of the axles where the brakes alone slow the car."""
    share, (load_f, load_r) = front_share(car, 0.0), axle_loads(car, np.array([z]))
    force = z * car.weight
    return share * force / float(load_f[0]), (1.0 - share) * force / float(load_r[0])


def test_the_reference_car_needs_70_bar_per_g():
    # 2 wheels x 2 faces x 0.38 x (28.84e-4 x 0.1309 + 11.34e-4 x 0.124) / 0.322, per Pa
    newton_per_pa = 4 * 0.38 * (28.84e-4 * 0.1309 + 11.34e-4 * 0.124) / 0.322
    assert pressure_per_g(VEHICLE) == pytest.approx(1744 * G / newton_per_pa, rel=1e-12)
    assert front_share(VEHICLE, 0.0) == pytest.approx(0.729, abs=5e-4)  # as the brief has it


def test_better_front_pads_take_their_share():
    odds = 28.84 * 130.9 / (11.34 * 124.0)  # Table I
    better, only_front = front_share(VEHICLE, np.array([math.log(1.5), 40.0]))
    assert better / (1.0 - better) == pytest.approx(1.5 * odds)
    assert only_front == pytest.approx(1.0)
    assert front_share(VEHICLE, -40.0) == pytest.approx(0.0, abs=1e-12)


def test_an_axle_locks_where_it_uses_the_friction_of_the_road():
    z = MU * lock_efficiency(VEHICLE, MU)
    assert max(friction_used(VEHICLE, z)) == pytest.approx(MU)


def test_both_axles_lock_at_once_where_the_bias_turns():
    z = front_biased_up_to(VEHICLE)
    assert lock_efficiency(VEHICLE, z) == pytest.approx(1.0, rel=1e-12)
    assert axle_loads(VEHICLE, np.array([z]))[0] == pytest.approx(
        front_share(VEHICLE, 0.0) * VEHICLE.weight
    )


def test_an_axle_may_never_lock():
    low = replace(VEHICLE, cg_height=1.1, rear=replace(VEHICLE.rear, piston_area=0.2))
    assert front_share(low, 0.0) < 0.1
    front, rear = friction_used(low, lock_efficiency(low, 1.0))
    assert rear == pytest.approx(1.0)
    assert front < 1.0

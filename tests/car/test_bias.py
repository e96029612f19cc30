"""Shares, friction used and first lock against statics worked out by hand."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import G
from calib.car.bias import (
    friction_used,
    front_biased_up_to,
    front_share,
    ideal_front_share,
    lock_efficiency,
    locks_at,
    pressure_per_g,
)
from tests.support.tables import VEHICLE

MU = 0.8


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
    front, rear = locks_at(VEHICLE, MU)
    assert friction_used(VEHICLE, np.array([front]))[0][0] == pytest.approx(MU, rel=1e-12)
    assert friction_used(VEHICLE, np.array([rear]))[1][0] == pytest.approx(MU, rel=1e-12)
    assert lock_efficiency(VEHICLE, MU) == min(front, rear) / MU < 1.0


def test_both_axles_lock_at_once_where_the_bias_turns():
    z = front_biased_up_to(VEHICLE)
    assert locks_at(VEHICLE, z) == pytest.approx((z, z), rel=1e-12)
    assert ideal_front_share(VEHICLE, np.array([z]))[0] == pytest.approx(front_share(VEHICLE, 0.0))


def test_an_axle_may_never_lock():
    low = replace(VEHICLE, cg_height=1.1, rear=replace(VEHICLE.rear, piston_area=0.2))
    assert front_share(low, 0.0) < 0.1
    assert locks_at(low, 1.0)[0] == np.inf

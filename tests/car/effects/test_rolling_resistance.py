"""Rolling resistance against the weight it takes its share of."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.car.effects.effect import acts_on_wheels
from calib.car.effects.rolling_resistance import EFFECT
from calib.car.forces import axle_loads
from tests.support.effect_runs import made_motion
from tests.support.tables import VEHICLE


def moments(vehicle, c_rr, z, v=20.0):
    load_f, load_r = axle_loads(vehicle, np.asarray([z]))
    return EFFECT.axle_moment(vehicle, {"coefficient": c_rr}, made_motion([v], load_f, load_r))


@given(st.floats(0.0, 0.05), st.floats(0.0, 1.0), st.floats(0.25, 0.4), st.floats(0.25, 0.4))
def test_is_its_share_of_the_weight_at_the_road(c_rr, z, R_f, R_r):
    """Whatever the load transfer and the radii, M_f/R_f + M_r/R_r = c_rr M g."""
    vehicle = replace(
        VEHICLE,
        front=replace(VEHICLE.front, rolling_radius=R_f),
        rear=replace(VEHICLE.rear, rolling_radius=R_r),
    )
    front, rear = moments(vehicle, c_rr, z)
    assert front / R_f + rear / R_r == pytest.approx(c_rr * 1744.0 * 9.80665)


def test_the_heavier_axle_has_more_of_it():
    """Static front load 10 056.7 N, at 1 % and 0.322 m: 32.4 N m."""
    front, rear = moments(VEHICLE, 0.01, 0.0)
    assert front == pytest.approx(0.01 * 10056.7 * 0.322, rel=1e-4)
    assert rear < front


def test_may_grow_with_the_square_of_the_speed():
    """0.9 of it at a standstill, and 1.8 of it at 60 m/s, by 0.1 (9 - 1)."""
    motion = made_motion([0.0, 20.0, 60.0], *(np.full(3, x) for x in (10e3, 7e3)))
    front, _ = EFFECT.axle_moment(VEHICLE, {"coefficient": 0.01, "rolling_growth": 0.1}, motion)
    assert front == pytest.approx(100.0 * VEHICLE.front.rolling_radius * np.array([0.9, 1.0, 1.8]))


@given(st.floats(0.0, 70.0))
def test_does_not_depend_on_speed_without_a_growth(v):
    assert moments(VEHICLE, 0.01, 0.3, v) == moments(VEHICLE, 0.01, 0.3)


def test_slows_the_wheels_and_not_the_body():
    assert acts_on_wheels(EFFECT)
    assert EFFECT.body_force is None

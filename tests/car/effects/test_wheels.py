"""Moments, inertia and radii of the wheels against Newton's law for the whole car."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.car.effects.catalogue import CATALOGUE
from calib.car.effects.effects import Effects
from calib.car.forces import axle_loads
from calib.run.known_effects import remove_known_effects
from tests.support.effect_runs import SEDAN, driven, made_history, made_motion

MOTOR = {"regen_torque": 300.0, "regen_power": 9e3, "regen_rear_share": 0.25, "regen_onset": 1.5e5}
RADIUS_BY_LOAD = {"rolling_radius_load": {"radius_load": 0.01}}


def moments(name, motion, car=SEDAN, **parameters):
    """Moments [N m] of an effect on the front and the rear axle."""
    return CATALOGUE[name].axle_moment(car, parameters, motion)


@given(st.floats(0.0, 0.05), st.floats(0.0, 1.0), st.floats(0.25, 0.4), st.floats(0.25, 0.4))
def test_rolling_resistance_is_its_share_of_the_weight_at_the_road(c_rr, z, R_f, R_r):
    """M_f/R_f + M_r/R_r = c_rr M g for any load transfer and any radii."""
    axles = (replace(SEDAN.front, rolling_radius=R_f), replace(SEDAN.rear, rolling_radius=R_r))
    car = replace(SEDAN, front=axles[0], rear=axles[1])
    motion = made_motion([20.0], *axle_loads(car, np.asarray([z])))
    front, rear = moments("rolling_resistance", motion, car, coefficient=c_rr)
    assert front / R_f + rear / R_r == pytest.approx(c_rr * 1744.0 * 9.80665)


def test_the_drag_of_an_engine_grows_and_is_shared():
    drag = {"drag_torque": 120.0, "drag_growth": 0.01, "drag_rear_share": 0.75}
    front, rear = moments("engine_drag", made_motion([10.0, 20.0, 35.0]), **drag)
    total = np.array([108.0, 120.0, 138.0])
    assert front == pytest.approx(0.25 * total)
    assert rear == pytest.approx(0.75 * total)


def test_torque_and_power_of_a_motor_and_the_end_of_a_stop():
    """With R = 0.322 m, 9 kW are 300 N m at 9.66 m/s, and 9e3 x 0.322/v above."""
    front, rear = moments("regenerative_torque", made_motion([1.5, 6.0, 9.0, 20.0, 40.0]), **MOTOR)
    total = [150.0, 300.0, 300.0, 9e3 * 0.322 / 20.0, 9e3 * 0.322 / 40.0]
    assert front == pytest.approx(0.75 * np.array(total))
    assert rear == pytest.approx(0.25 * np.array(total))


def motor_at(p_mc, time=None, **more):
    """Front torque of the motor [N m] at 8 m/s, where the torque limit holds."""
    p = np.asarray(p_mc, float)
    history = made_history(p.size, p_mc=p, **({} if time is None else {"time": time}))
    motion = replace(made_motion(np.full(p.size, 8.0)), history=history)
    return moments("regenerative_torque", motion, **MOTOR, **more)[0]


@pytest.mark.parametrize(
    ("span", "bar", "share"),
    [
        ({}, [1.49, 1.8, 2.11], [0.0, 0.5, 1.0]),
        ({"regen_span": 6e5}, [1.4, 4.5, 7.5, 9.0], [0.0, 0.5, 1.0, 1.0]),
    ],
)
def test_the_torque_of_a_motor_rises_over_its_span(span, bar, share):
    """It begins at 1.5 bar; without a span it is complete at a pressure 40 % higher."""
    assert motor_at(np.array(bar) * 1e5, **span) == pytest.approx(225.0 * np.array(share))


def test_a_motor_follows_the_pedal_with_its_time_constant():
    """After a step at 0.2 s it has 63 % one time constant later, and falls likewise."""
    time = np.arange(600) * 0.001
    front = motor_at(np.where((time >= 0.2) & (time < 0.4), 9e5, 0.0), time, regen_lag=0.03)
    assert np.all(front[:200] == 0.0)
    assert front[230] == pytest.approx(225.0 * (1.0 - np.exp(-1.0)), rel=0.03)
    assert front[430] == pytest.approx(225.0 * np.exp(-1.0), rel=0.03)


def test_a_loaded_wheel_turns_faster_and_the_analysis_takes_it_out():
    """The loads over those at rest are 1 + z h/l_r and 1 - z h/l_f; no other channel changes."""
    bare, loaded = driven({}), driven(RADIUS_BY_LOAD)
    z = -bare["a_x"] / 9.80665
    for w, ratio in (("fl", z * 0.615 / 1.6494), ("rl", -z * 0.615 / 1.1556)):
        speeds = loaded[f"omega_{w}"] / bare[f"omega_{w}"]
        assert speeds == pytest.approx(np.exp(0.01 * ratio), rel=1e-9)
    for channel in ("a_x", "v"):
        assert np.array_equal(loaded[channel], bare[channel])
    clean = remove_known_effects(replace(SEDAN, effects=Effects(RADIUS_BY_LOAD)), loaded)
    for w in ("fl", "fr", "rl", "rr"):
        assert clean.log[f"omega_{w}"] == pytest.approx(bare[f"omega_{w}"], rel=1e-9)

"""Regeneration against its limits and against Newton's law for the whole car."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.regenerative_torque import EFFECT
from tests.support.effect_runs import SEDAN, driven, made_history, made_motion, without_inertia

MOTOR = {
    "regen_torque": 300.0,
    "regen_power": 9e3,
    "regen_rear_share": 0.25,
    "regen_onset": 1.5e5,
}


def slowly(history):
    """The motion at 8 m/s, where the torque of the motor is its limit, with a history."""
    return replace(made_motion(np.full(history.p_mc.size, 8.0)), history=history)


def test_torque_power_and_the_end_of_a_stop():
    """R = 0.322 m: 9 kW are 300 N m at 9.66 m/s, 9e3 x 0.322/v above."""
    motion = made_motion([1.5, 6.0, 9.0, 20.0, 40.0])
    front, rear = EFFECT.axle_moment(SEDAN, MOTOR, motion)
    whole = [150.0, 300.0, 300.0, 9e3 * 0.322 / 20.0, 9e3 * 0.322 / 40.0]
    assert front == pytest.approx(0.75 * np.array(whole))
    assert rear == pytest.approx(0.25 * np.array(whole))


def test_none_without_the_brake():
    """From 1.5 bar on, and in full 40 % above it."""
    history = made_history(3, p_mc=np.array([1.49e5, 1.8e5, 2.11e5]))
    motion = slowly(history)
    front, _ = EFFECT.axle_moment(SEDAN, MOTOR, motion)
    assert front == pytest.approx([0.0, 112.5, 225.0])


def test_a_torque_that_follows_the_pedal():
    """From 1.5 bar on, in full 6 bar above: a half 3 bar above."""
    history = made_history(4, p_mc=np.array([1.4e5, 4.5e5, 7.5e5, 9e5]))
    motion = slowly(history)
    front, _ = EFFECT.axle_moment(SEDAN, {**MOTOR, "regen_span": 6e5}, motion)
    assert front == pytest.approx([0.0, 112.5, 225.0, 225.0])


def test_a_torque_that_lags():
    """On at once at 0.2 s: 63 % of it one time constant later, and as much less after the end."""
    time = np.arange(600) * 0.001
    pedal = np.where((time >= 0.2) & (time < 0.4), 9e5, 0.0)
    history = made_history(600, time=time, p_mc=pedal)
    motion = slowly(history)
    front, _ = EFFECT.axle_moment(SEDAN, {**MOTOR, "regen_lag": 0.03}, motion)
    assert np.all(front[:200] == 0.0)
    assert front[230] == pytest.approx(225.0 * (1.0 - np.exp(-1.0)), rel=0.03)
    assert front[430] == pytest.approx(225.0 * np.exp(-1.0), rel=0.03)


@pytest.mark.parametrize("share", [0.0, 1.0])
def test_braking_with_the_motor(share):
    """Below base speed: a constant force at the road beside that of the pads."""
    motor = {**MOTOR, "regen_power": 50e3, "regen_rear_share": share}
    car = without_inertia(SEDAN)
    log = driven({"regenerative_torque": motor}, lambda t: 10e5, 20.0, car=car)
    bare = driven({}, lambda t: 10e5, 20.0, car=car)
    force = 300.0 / 0.322
    assert log["a_x"] == pytest.approx(bare["a_x"] - force / SEDAN.mass)
    axle = "fr"[round(share)]
    assert log.truth[f"true_Fx_{axle}l"] == pytest.approx(
        bare.truth[f"true_Fx_{axle}l"] + 0.5 * force
    )
    other = "rf"[round(share)]
    assert log.truth[f"true_Fx_{other}l"] == pytest.approx(bare.truth[f"true_Fx_{other}l"])


def test_speed_follows_from_the_power():
    """At full power m v dv/dt = -P - F v: the energy lost is the work of pads and motor."""
    motor = {**MOTOR, "regen_torque": 3000.0, "regen_rear_share": 0.0}
    car = without_inertia(SEDAN)
    log = driven({"regenerative_torque": motor}, lambda t: 10e5, car=car)
    v, t = log["v"], log.time
    pads = 2.0 * (log.truth["true_Tb_fl"] + log.truth["true_Tb_rl"]) / 0.322
    work = np.trapezoid(pads * v + 9e3, t)
    assert 0.5 * SEDAN.mass * (v[0] ** 2 - v[-1] ** 2) == pytest.approx(work, rel=1e-5)

"""The second order against the solutions of its equation."""

import numpy as np
import pytest

from tests.support.effect_runs import (
    SEDAN,
    apart,
    driven,
    made_history,
    on_the_plant,
    pressures,
)

SWING = {"response_time": 0.08, "line_damping": 0.4}
GAIN = SEDAN.front.pad_friction * SEDAN.front.torque_gain


def ramp_answer(t, T=0.08, D=0.4):
    """Return t - 2 D T + exp(-D t/T) (2 D T cos(w t) + T (2 D^2 - 1)/sqrt(1 - D^2) sin(w t))."""
    w = np.sqrt(1.0 - D * D) / T
    swing = 2 * D * T * np.cos(w * t) + T * (2 * D * D - 1) / np.sqrt(1 - D * D) * np.sin(w * t)
    return t - 2 * D * T + np.exp(-D * t / T) * swing


def test_a_ramp_is_behind_by_twice_damping_times_response():
    log = driven({"hydraulic_oscillation": SWING}, lambda t: 6e5 * t)
    assert log.truth["true_Tb_fl"] / GAIN == pytest.approx(6e5 * ramp_answer(log.time), abs=1.0)


def test_a_step_overshoots_as_the_damping_has_it():
    time = np.arange(2000) * 0.001
    history = made_history(2000, time=time, p_mc=np.where(time >= 0.1, 20e5, 0.0))
    front, rear = pressures("hydraulic_oscillation", history, **SWING)
    assert front.max() == pytest.approx(
        20e5 * (1.0 + np.exp(-np.pi * 0.4 / np.sqrt(1.0 - 0.16))), rel=1e-3
    )
    assert front[-1] == pytest.approx(20e5, rel=1e-3)
    assert np.array_equal(front, rear)


def test_goes_over_into_nothing():
    history = made_history()
    none, _ = pressures("hydraulic_oscillation", history, response_time=0.0, line_damping=0.4)
    short, _ = pressures("hydraulic_oscillation", history, response_time=1e-5, line_damping=0.4)
    assert none is history.p_mc
    assert short == pytest.approx(none, abs=1e-4 * 40e5)


def test_follows_the_plant_under_the_swinging_pressure():
    log = driven({"hydraulic_oscillation": SWING}, lambda t: 6e5 * t)
    run = on_the_plant(lambda t: 6e5 * ramp_answer(t))
    assert apart(log, run, "v") < 2e-3
    assert apart(driven({}, lambda t: 6e5 * t), run, "v") > 0.05

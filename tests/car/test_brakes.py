"""Brake torques from the pedal: which effect acts on which wheel, and in which order."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.brakes import brakes_of
from calib.car.effects.effects import Effects
from calib.car.history import constant_speed
from calib.car.model import default_model
from tests.support.effect_runs import SEDAN

TIME = np.arange(100) * 0.01
PRESSURE = 30e5 * np.sin(2.0 * TIME)


def brakes(effects, logged=None, p=PRESSURE):
    history = constant_speed(TIME, p, 20.0)
    model = replace(default_model(SEDAN), effects=Effects(effects))
    return brakes_of(model, history, logged or {}), history


def test_without_effects_two_wheels_stand_for_four():
    computed, history = brakes({})
    assert tuple(computed.clamp) == ("fl", "rl")
    assert computed.clamp["rl"] is history.p_mc
    assert [computed.twin(w) for w in ("fl", "fr", "rl", "rr")] == ["fl", "fl", "rl", "rl"]
    gain = 0.38 * 2 * 28.84e-4 * 0.1309  # Table I
    assert computed.torques(history)["fl"] == pytest.approx(gain * PRESSURE)


def test_the_pressure_passes_valve_then_seal_in_any_order_of_the_file():
    valve = {"rear_proportioning": {"knee_slope": 0.5, "knee": 10e5}}
    seal = {"brake_threshold_pressure": {"threshold": 2e5}}
    for effects in (valve | seal, seal | valve):
        computed, _ = brakes(effects, p=np.full(100, 20e5))
        assert computed.clamp["fl"] == pytest.approx(18e5)
        assert computed.clamp["rl"] == pytest.approx(13e5)  # 10 + 0.5 * 10 - 2


def test_a_logged_wheel_pressure_is_behind_the_line_and_before_the_caliper():
    effects = {"hydraulic_delay": {"delay": 0.05}, "brake_threshold_pressure": {"threshold": 1e5}}
    logged = {"rl": PRESSURE + 5e5}
    computed, _ = brakes(effects, logged)
    assert tuple(computed.clamp) == ("fl", "fr", "rl", "rr")
    assert computed.clamp["rl"] == pytest.approx(PRESSURE + 4e5)
    assert computed.clamp["rr"][5:] == pytest.approx(np.maximum(PRESSURE[:-5] - 1e5, 0.0))
    assert np.array_equal(computed.clamp["fl"], computed.clamp["fr"])

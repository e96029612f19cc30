"""From the pedal to the torques: what acts where, in which order, on which wheel."""

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


def brakes(effects, own=None, p=PRESSURE):
    rest = constant_speed(TIME, p, 20.0)
    return brakes_of(replace(default_model(SEDAN), effects=Effects(effects)), rest, own or {}), rest


def test_without_effects_the_clamp_is_the_pedal_and_two_wheels_stand_for_four():
    found, rest = brakes({})
    assert tuple(found.clamp) == ("fl", "rl")
    assert found.clamp["rl"] is rest.p_mc
    assert [found.twin(w) for w in ("fl", "fr", "rl", "rr")] == ["fl", "fl", "rl", "rl"]
    gain = 0.38 * 2 * 28.84e-4 * 0.1309  # Table I
    assert found.torques(rest)["fl"] == pytest.approx(gain * PRESSURE)


def test_the_fluid_meets_valve_before_seal_whatever_the_order_of_the_file():
    valve = {"rear_proportioning": {"knee_slope": 0.5, "knee": 10e5}}
    seal = {"brake_threshold_pressure": {"threshold": 2e5}}
    for effects in (valve | seal, seal | valve):
        found, _ = brakes(effects, p=np.full(100, 20e5))
        assert found.clamp["fl"] == pytest.approx(18e5)
        assert found.clamp["rl"] == pytest.approx(13e5)  # 10 + 0.5 * 10 - 2


def test_a_logged_wheel_pressure_is_behind_the_line_and_before_the_caliper():
    effects = {"hydraulic_delay": {"delay": 0.05}, "brake_threshold_pressure": {"threshold": 1e5}}
    own = {"rl": PRESSURE + 5e5}
    found, _ = brakes(effects, own)
    assert tuple(found.clamp) == ("fl", "fr", "rl", "rr")
    assert found.clamp["rl"] == pytest.approx(PRESSURE + 4e5)
    assert found.clamp["rr"][5:] == pytest.approx(np.maximum(PRESSURE[:-5] - 1e5, 0.0))
    assert np.array_equal(found.clamp["fl"], found.clamp["fr"])

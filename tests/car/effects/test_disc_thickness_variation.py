"""Thickness variation: once a turn, as the wheel itself has turned."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.integrate import cumulative_simpson

from calib.car.effects.disc_thickness_variation import EFFECT
from tests.support.effect_runs import driven, made_history


@given(st.floats(0.0, 0.3), st.floats(-np.pi, np.pi), st.floats(0.0, 1000.0))
def test_a_sine_of_the_front_angle(amplitude, phase, angle):
    history = made_history(2, angle_f=np.array([0.0, angle]))
    found = EFFECT.wheels({"amplitude": amplitude, "phase": phase, "side": 0.0}, history)
    for wheel in ("fl", "fr"):
        assert found[wheel][1] == pytest.approx(1.0 + amplitude * np.sin(angle + phase))
    assert set(found) == {"fl", "fr"}


@pytest.mark.parametrize(("side", "still"), [(1.0, "fr"), (-1.0, "fl")])
def test_one_disc_alone(side, still):
    history = made_history(2, angle_f=np.array([0.0, 1.0]))
    found = EFFECT.wheels({"amplitude": 0.1, "phase": 0.0, "side": side}, history)
    assert found[still] == pytest.approx(np.ones(2))


def test_the_torque_pulses_with_the_turn_of_its_wheel():
    even = driven({}, duration=3.0).truth["true_Tb_fl"]
    log = driven(
        {"disc_thickness_variation": {"amplitude": 0.04, "phase": 0.7, "side": 0.0}},
        duration=3.0,
        rate=1000,
    )
    angle = cumulative_simpson(log["omega_fl"], x=log.time, initial=0.0)
    expected = even[0] * (1.0 + 0.04 * np.sin(angle + 0.7))
    assert log.truth["true_Tb_fl"] == pytest.approx(expected, rel=1e-3)
    assert np.array_equal(log["omega_fl"], log["omega_fr"])
    assert np.ptp(log.truth["true_Tb_rl"]) == pytest.approx(0.0, abs=1e-9)

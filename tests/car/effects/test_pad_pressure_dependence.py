"""Pressure dependence: torque over pressure is a parabola."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.car.effects.pad_pressure_dependence import EFFECT
from tests.support.effect_runs import SEDAN, driven, made_history, wave


@given(st.floats(-8e-8, 8e-8), st.floats(0.0, 150e5), st.floats(0.0, 150e5))
def test_a_line_through_one_at_20_bar_for_each_axle_by_itself(slope, p_f, p_r):
    found = EFFECT.friction(
        {"pressure_slope": slope}, made_history(1), np.array([p_f]), np.array([p_r])
    )
    assert found[0] == pytest.approx([1.0 + slope * (p_f - 20e5)])
    assert found[1] == pytest.approx([1.0 + slope * (p_r - 20e5)])


@given(st.floats(-1e-7, 1e-7), st.floats(0.0, 4e-6))
def test_a_bend_keeps_one_at_20_bar_and_the_mean_slope_to_40_bar(slope, bend):
    given_by = {"pressure_slope": slope, "pressure_bend": bend}
    p = np.array([0.0, 20e5, 40e5])
    factor, _ = EFFECT.friction(given_by, made_history(3), p, p)
    assert factor[1] == pytest.approx(1.0, abs=1e-12)
    assert factor[2] - factor[0] == pytest.approx(slope * 40e5, abs=1e-9)


def test_a_bend_follows_a_lining_that_goes_with_a_power_of_pressure():
    """mu over p^-0.1, scaled to 20 bar: the straight line of the same two ends errs by 8 %."""
    p = np.linspace(3e5, 60e5, 100)
    power = (p / 20e5) ** -0.1
    bent, _ = EFFECT.friction({"pressure_slope": -7.4e-8, "pressure_bend": 5.7e-7}, None, p, p)
    assert bent == pytest.approx(power, rel=0.035)
    slope = (power[-1] - power[0]) / (p[-1] - p[0])
    assert np.max(np.abs(power[0] + slope * (p - p[0]) - power)) > 0.08


def test_the_torque_bends():
    log = driven({"pad_pressure_dependence": {"pressure_slope": -3e-8}}, wave)
    p = log["p_mc"]
    straight = 0.38 * 2 * 28.84e-4 * 0.1309 * p  # Table I
    assert log.truth["true_Tb_fr"] == pytest.approx(straight * (1.0 - 3e-8 * (p - 20e5)))
    assert SEDAN.front.pad_friction == 0.38


def test_the_proportioned_rear_feels_its_own_pressure():
    both = {
        "pad_pressure_dependence": {"pressure_slope": -3e-8},
        "rear_proportioning": {"knee_slope": 0.4, "knee": 10e5},
    }
    log = driven(both)
    own = 10e5 + 0.4 * 15e5
    rear = SEDAN.rear.pad_friction * SEDAN.rear.torque_gain * own * (1.0 - 3e-8 * (own - 20e5))
    assert log.truth["true_Tb_rl"] == pytest.approx(rear)

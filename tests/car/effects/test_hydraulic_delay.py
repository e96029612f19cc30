"""Delay: the same shape, later."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.effect_runs import (
    SEDAN,
    apart,
    driven,
    made_history,
    on_the_plant,
    pressures,
    wave,
)


@given(st.floats(-0.05, 0.5))
def test_a_straight_pressure_is_met_exactly(delay):
    history = made_history(p_mc=3e5 + 8e5 * np.arange(200) * 0.01)
    for found in pressures("hydraulic_delay", history, delay=delay):
        assert found == pytest.approx(np.clip(history.p_mc - 8e5 * delay, 3e5, history.p_mc[-1]))


@pytest.mark.parametrize("samples", [1, 7, 50])
def test_whole_samples_shift(samples):
    history = made_history()
    front, _ = pressures("hydraulic_delay", history, delay=0.01 * samples)
    assert front[samples:] == pytest.approx(history.p_mc[:-samples])
    assert front[:samples] == pytest.approx(history.p_mc[0])


def test_follows_the_plant_under_the_late_pressure():
    log = driven({"hydraulic_delay": {"delay": 0.08}}, wave)
    run = on_the_plant(lambda t: wave(max(t - 0.08, 0.0)))
    gain = SEDAN.front.pad_friction * SEDAN.front.torque_gain
    assert apart(log, run, "true_Tb_fl") < 1e-4 * gain * 30e5  # straight between samples
    assert apart(log, run, "v") < 3e-3
    assert apart(driven({}, wave), run, "v") > 0.05

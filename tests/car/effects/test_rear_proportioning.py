"""Proportioning: a knee, on the rear alone."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.effect_runs import apart, driven, made_history, on_the_plant, pressures, wave


def valve(p, slope=0.4, knee=15e5):
    return p if p < knee else knee + slope * (p - knee)


@given(st.floats(0.0, 1.0), st.floats(0.0, 150e5), st.floats(0.0, 200e5))
def test_sample_by_sample(slope, knee, p):
    history = made_history(2, p_mc=np.array([0.0, p]))
    front, rear = pressures("rear_proportioning", history, knee_slope=slope, knee=knee)
    assert front is history.p_mc
    assert rear == pytest.approx([0.0, valve(p, slope, knee)], abs=1e-6)


def test_follows_the_plant_with_a_valve():
    log = driven({"rear_proportioning": {"knee_slope": 0.4, "knee": 15e5}}, wave)
    run = on_the_plant(wave, own={w: lambda t: valve(wave(t)) for w in ("rl", "rr")})
    assert apart(log, run, "true_Tb_rr") < 1e-6
    assert apart(log, run, "omega_rl") < 0.01
    assert apart(log, run, "v") < 3e-3
    assert "p_rl" not in log

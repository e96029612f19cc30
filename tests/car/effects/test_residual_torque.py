"""What stays of an application, against its recursion and the plant."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from calib.car.effects.residual_torque import clamped
from tests.support.effect_runs import apart, driven, made_history, on_the_plant, pressures

STUCK = {"residual_pressure": 2e5, "drain_time": 5.0, "rear_bias": 1.0}


@given(
    arrays(float, st.integers(1, 200), elements=st.floats(-1e5, 100e5)),
    st.floats(1e3, 20e5),
    st.floats(1.0, 60.0),
)
def test_sample_by_sample(p, most, drain):
    time = 5.0 + 0.3 * np.arange(p.size)
    left, expected = 0.0, []
    for now in p:
        left = max(left * np.exp(-0.3 / drain), min(now, most) if now > 1.5e5 else 0.0)
        expected.append(max(now, left) if left > 0.0 else now)
    assert clamped(time, p, most, drain) == pytest.approx(np.array(expected), rel=1e-6, abs=1e-6)


def test_an_hour_does_not_overflow():
    p = np.where(np.arange(3600) % 600 < 5, 30e5, 0.0)
    found = clamped(np.arange(3600.0), p, 2e5, 1.0)
    assert np.all(np.isfinite(found))
    assert found[5] == pytest.approx(2e5 * np.exp(-1.0))
    assert found[599] == 0.0 or found[599] < 1.0


def test_nothing_before_the_first_application():
    history = made_history(p_mc=np.where(np.arange(200) < 100, 1e5, 20e5))
    for found in pressures("residual_torque", history, **{**STUCK, "rear_bias": 0.0}):
        assert np.array_equal(found, history.p_mc)


@pytest.mark.parametrize(
    ("bias", "kept"), [(0.0, (2.0, 2.0)), (1.0, (0.0, 2.0)), (-0.5, (2.0, 1.0))]
)
def test_an_axle_may_have_it_alone(bias, kept):
    history = made_history(p_mc=np.where(np.arange(200) < 100, 20e5, 0.0))
    found = pressures("residual_torque", history, **{**STUCK, "rear_bias": bias})
    for pressure, bar in zip(found, kept, strict=True):
        assert pressure[199] == pytest.approx(bar * 1e5 * np.exp(-1.0 / 5.0))


def test_follows_the_plant_whose_rear_brakes_are_told_what_stays():
    def pedal(t):
        return 20e5 * min(max(11.0 - 5.0 * t, 0.0), 1.0)  # released from 2 to 2.2 s

    def rear(t):
        return pedal(t) if t < 2.18 else 2e5 * np.exp(-(t - 2.18) / 5.0)

    run = on_the_plant(pedal, own={"rl": rear, "rr": rear})
    log = driven({"residual_torque": STUCK}, pedal)
    assert apart(log, run, "v") < 5e-3
    assert apart(driven({}, pedal), run, "v") > 0.1

"""Threshold: a dead zone around nought."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tests.support.effect_runs import SEDAN, driven, made_history, pressures, wave


@given(st.floats(0.0, 10e5), st.floats(0.0, 150e5))
def test_what_is_above_the_threshold(threshold, p):
    history = made_history(1, p_mc=np.array([p]))
    for found in pressures("brake_threshold_pressure", history, threshold=threshold):
        assert found == pytest.approx([max(p - threshold, 0.0)], abs=1e-6)


@given(st.floats(1e3, 3e5), st.floats(0.0, 150e5), st.booleans())
def test_a_sensor_whose_zero_reads_too_low_is_a_threshold_below_zero(low, true, clipped):
    """It reads ``low`` less, or zero: a released brake is released, a pressed one comes back."""
    read = max(true - low, 0.0) if clipped else true - low
    history = made_history(1, p_mc=np.array([read]))
    for found in pressures("brake_threshold_pressure", history, threshold=-low):
        assert -1e-6 <= found[0] <= true + 1e-6
        if true == 0.0 or true > 2.0 * low:
            assert found == pytest.approx([true], abs=1e-6)


@pytest.mark.parametrize(
    ("share", "front", "rear"),
    [(0.0, 2e5, 0.0), (0.25, 2e5, 1e5), (0.5, 2e5, 2e5), (1.0, 0.0, 2e5)],
)
def test_an_axle_has_its_share_of_the_threshold(share, front, rear):
    history = made_history(1, p_mc=np.array([30e5]))
    given = {"threshold": 2e5, "threshold_rear_share": share}
    found = pressures("brake_threshold_pressure", history, **given)
    assert [float(p[0]) for p in found] == pytest.approx([30e5 - front, 30e5 - rear])


def test_noise_at_rest_stays_without_a_mean():
    noise = np.random.default_rng(0).normal(0.0, 0.1e5, 1000)
    history = made_history(1000, p_mc=np.concatenate([noise[:500], -noise[:500]]))
    for threshold in (0.0, 0.05e5, 2e5):
        front, _ = pressures("brake_threshold_pressure", history, threshold=threshold)
        assert np.mean(front) == pytest.approx(0.0, abs=1e-9)
    assert np.all(front == 0.0)


def test_the_same_torque_is_missing_at_every_pressure():
    log = driven({"brake_threshold_pressure": {"threshold": 2e5}}, wave)
    biting = log["p_mc"] > 2e5
    gain = SEDAN.rear.pad_friction * SEDAN.rear.torque_gain
    missing = gain * log["p_mc"] - log.truth["true_Tb_rl"]
    assert missing[biting] == pytest.approx(gain * 2e5)
    assert np.all(log.truth["true_Tb_rl"][~biting] == 0.0)
    assert np.count_nonzero(~biting) > 20

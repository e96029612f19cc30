"""Lag of the accelerometer: a ramp is read late by the time constant, a constant as it is."""

import numpy as np
import pytest
from scipy.signal import butter, lsim

from tests.support.effect_runs import driven


def test_a_ramp_of_deceleration_is_read_late_by_the_time_constant():
    late = driven({"accelerometer_lag": {"filter_time": 0.05}}, lambda t: 6e5 * t)
    right = driven({}, lambda t: 6e5 * t)
    t = right.time
    settled = t > 1.5
    expected = np.interp(t - 0.05, t, right["a_x"])
    assert late["a_x"][settled] == pytest.approx(expected[settled], abs=2e-3)
    assert np.max(np.abs(late["a_x"] - right["a_x"])) > 0.03
    for channel in ("v", "omega_fl", "omega_rr"):
        assert np.array_equal(late[channel], right[channel])


def test_a_step_is_reached_by_63_percent_after_the_time_constant():
    step = lambda t: 25e5 * (t > 1.0)  # noqa: E731
    late = driven({"accelerometer_lag": {"filter_time": 0.2}}, step)
    right = driven({}, step)
    k = np.searchsorted(right.time, 1.2)
    before, after = right["a_x"][100], right["a_x"][k]
    assert (late["a_x"][k] - before) / (after - before) == pytest.approx(1 - np.exp(-1), abs=0.03)


def test_a_bend_of_one_half_is_the_filter_of_butterworth():
    """Second order with its corner at 3 Hz, against SciPy's analogue filter."""
    step = lambda t: 25e5 * (t > 1.0)  # noqa: E731
    corner = 2.0 * np.pi * 3.0
    filtered = {"filter_time": np.sqrt(2.0) / corner, "filter_bend": 0.5}
    late = driven({"accelerometer_lag": filtered}, step)
    right = driven({}, step)
    start = right["a_x"][0]
    _, expected, _ = lsim(butter(2, corner, analog=True), right["a_x"] - start, right.time)
    assert late["a_x"] == pytest.approx(start + expected, abs=0.01)

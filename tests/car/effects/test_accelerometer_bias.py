"""Bias: the reading is off, the car is not."""

import numpy as np
import pytest

from tests.support.effect_runs import driven, wave


@pytest.mark.parametrize("bias", [0.2, -0.1])
def test_the_reading_is_off_and_nothing_else(bias):
    log, true = driven({"accelerometer_bias": {"bias": bias}}, wave), driven({}, wave)
    assert log["a_x"] - true["a_x"] == pytest.approx(bias)
    for channel in ("v", "omega_fl", "omega_rr"):
        assert np.array_equal(log[channel], true[channel])
    assert np.array_equal(log.truth["true_Fz_fl"], true.truth["true_Fz_fl"])


def test_the_scale_is_of_what_is_sensed_and_not_of_the_bias():
    bias, scale = {"bias": 0.5}, {"scale_error": 0.1}
    one = driven({"accelerometer_bias": bias, "accelerometer_scale": scale}, wave)
    other = driven({"accelerometer_scale": scale, "accelerometer_bias": bias}, wave)
    assert np.array_equal(one["a_x"], other["a_x"])
    assert one["a_x"] == pytest.approx(1.1 * driven({}, wave)["a_x"] + 0.5)

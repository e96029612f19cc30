"""Scale: the reading is off in proportion, the car is not."""

import numpy as np
import pytest

from tests.support.effect_runs import driven, wave


@pytest.mark.parametrize("error", [0.05, -0.03])
def test_the_reading_is_off_in_proportion_and_nothing_else(error):
    log, true = driven({"accelerometer_scale": {"scale_error": error}}, wave), driven({}, wave)
    assert log["a_x"] == pytest.approx((1.0 + error) * true["a_x"])
    assert np.min(true["a_x"]) < -2.0
    for channel in ("v", "omega_fl", "omega_rr"):
        assert np.array_equal(log[channel], true[channel])

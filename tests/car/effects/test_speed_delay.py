"""Delay of the reference speed: v of an earlier time, and nothing else."""

import numpy as np
import pytest

from calib.car.lag import delayed
from calib.model.replay import first_speed
from tests.support.effect_runs import SEDAN, driven, wave


@pytest.mark.parametrize("late", [0.02, 0.13])
def test_v_is_that_of_an_earlier_time_and_nothing_else_changes(late):
    log, right = driven({"speed_delay": {"v_delay": late}}, wave), driven({}, wave)
    n = round(late * 200)
    assert log["v"][n:] == pytest.approx(right["v"][:-n], abs=1e-9)
    for channel in ("a_x", "omega_fl", "omega_rr"):
        assert np.array_equal(log[channel], right[channel])


def test_before_the_first_sample_the_line_of_the_first_two_goes_on():
    time = np.array([1.0, 1.5, 2.5])
    assert delayed(time, np.array([4.0, 3.0, 0.0]), 0.75) == pytest.approx([5.5, 4.5, 2.25])


def test_the_first_speed_is_that_of_the_car_not_of_the_reading():
    log = driven({"speed_delay": {"v_delay": 0.1}}, lambda t: 30e5, v0=30.0)
    assert log["v"][0] > 30.1
    assert first_speed(log, SEDAN, 0.1) == pytest.approx(30.0, abs=0.02)

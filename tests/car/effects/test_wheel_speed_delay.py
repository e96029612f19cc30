"""Delay of the wheel speeds: all four of an earlier time, and nothing else."""

import numpy as np
import pytest

from calib.base.names import WHEELS
from tests.support.effect_runs import driven, wave


def test_wheel_speeds_are_those_of_an_earlier_time_and_nothing_else_changes():
    log, right = driven({"wheel_speed_delay": {"omega_delay": 0.04}}, wave), driven({}, wave)
    for w in WHEELS:
        assert log[f"omega_{w}"][8:] == pytest.approx(right[f"omega_{w}"][:-8], abs=1e-9)
    for channel in ("a_x", "v"):
        assert np.array_equal(log[channel], right[channel])

"""Stops with a foot that pumps, in a plant whose brakes follow late."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.estimation.estimator import estimate
from calib.fitting.fit import fit
from calib.validation.followed import WHY, followed
from calib.validation.validate import validate
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, noisy, ramp, stop

LATE = replace(REAL, hydraulic_lag=0.03)
PRESSURE, SWING = 28e5, 18e5


def pumped(plant, swing=SWING):
    """A stop at 28 bar, up and down by 18 bar at 1.5 Hz."""

    def pressure(t):
        turn = math.sin(2.0 * math.pi * 1.5 * (t - 1.5))
        return (PRESSURE + swing * turn) * min(max((t - 1.5) / 0.25, 0.0), 1.0)

    return as_log(drive(plant, pressure, 27.0, duration=9.0, stop_speed=1.5), "pumped")


@pytest.fixture(scope="module")
def table():
    return fit(CAR, [noisy(ramp(LATE), 1)])


def test_a_foot_that_pumps_has_no_valid_sample_and_is_told_why(table):
    (result,) = validate(table, [noisy(pumped(LATE), 2)])
    assert result.refused[WHY] > 0.8
    assert result.figures["valid_share"] < 0.2
    assert result.verdict == "failed"


def test_a_foot_that_holds_loses_no_sample(table):
    for log in (stop(LATE, PRESSURE), pumped(LATE, swing=1e5)):
        e = estimate(table, noisy(log, 3))
        assert np.array_equal(followed(e).valid, e.valid)


def test_brakes_that_follow_at_once_may_be_pumped(table):
    """Their delay is measured as nearly none, whatever the pressure does."""
    e = estimate(table, noisy(pumped(REAL), 4))
    assert np.mean(followed(e).valid[e.valid]) > 0.9

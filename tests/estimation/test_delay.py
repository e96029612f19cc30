"""Stops with a foot that pumps, in a plant whose brakes follow late."""

import math
from dataclasses import replace

import numpy as np
import pytest

from calib.base.intervals import Z95
from calib.estimation.budget import budget
from calib.estimation.delay import with_delay
from calib.estimation.estimator import estimate
from calib.estimation.validate import validate
from calib.fitting.fit import fit
from tests.support.plant import as_log, drive
from tests.support.reference_car import CAR, REAL, held, noisy, ramp, stop

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


@pytest.fixture(scope="module")
def late(table):
    """The estimate of a stop with a foot that pumps."""
    return estimate(table, noisy(pumped(LATE), 2), with_laws=False)


def test_the_intervals_hold_the_pads_of_a_foot_that_pumps(late):
    wider = replace(with_delay(late), valid=late.valid)
    assert min(held(late)) < 0.9
    assert min(held(wider)) > 0.85


def test_a_foot_that_pumps_where_brakes_are_very_late_has_no_valid_sample(table):
    (result,) = validate(table, [noisy(pumped(replace(LATE, hydraulic_lag=0.15)), 2)])
    assert result.figures["valid_share"] < 0.1
    front, _ = result.limiting
    assert front.largest == "delay"


def test_a_foot_that_holds_loses_no_sample(table):
    for log in (stop(LATE, PRESSURE), pumped(LATE, swing=1e5)):
        e = estimate(table, noisy(log, 3), with_laws=False)
        wider = with_delay(e)
        assert np.mean(wider.valid[e.valid]) > 0.98
        assert np.median((wider.front.half_width / e.front.half_width)[wider.valid]) < 1.05


def test_the_budget_has_the_delay_and_adds_up(late):
    e = with_delay(late)
    for axle, made_of in zip((e.front, e.rear), budget(e), strict=True):
        widths = np.sort((np.log(axle.upper / axle.lower) / (2.0 * Z95))[e.valid])
        assert made_of.parts["delay"] > 0.0
        assert made_of.sigma == pytest.approx(widths[(widths.size - 1) // 2], rel=1e-9)

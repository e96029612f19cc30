"""A late speed is seen against a_x and put in time; no scale, slope or zero is taken for it."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import G
from calib.run.axle_signals import signals
from calib.run.speed_delay import speed_delay
from tests.support.made_runs import changed
from tests.support.reference_car import CAR, REAL, noisy, ramp, stop

RUNS = {
    "ramp": noisy(ramp(REAL, slope=10e5), 1),
    "stop": noisy(stop(REAL), 2),
    "stop on a slope": noisy(stop(replace(REAL, grade=0.12)), 3),
}


def late(log, delay):
    """The log with v late by ``delay`` [s]."""
    return changed(log, v=np.interp(log.time - delay, log.time, log["v"]))


def delay_of(log):
    return speed_delay(log.time, log["v"], log["a_x"], log.sample_time)


@pytest.mark.parametrize("name", RUNS)
@pytest.mark.parametrize("delay", [0.1, 0.45])
def test_a_late_speed_is_put_in_time(name, delay):
    log = RUNS[name]
    estimate = delay_of(late(log, delay))
    assert estimate.late
    assert estimate.value == pytest.approx(delay, abs=max(3.0 * estimate.sigma, 0.01))
    s = signals(late(log, delay), CAR.rear.rolling_radius)
    inner = (log.time > 0.5) & (log.time < log.time[-1] - 0.5)
    off = (s.v - log["v"])[inner]
    assert np.sqrt(np.mean(off**2)) < 0.15  # late by 0.2 s it is 0.7 m/s


@pytest.mark.parametrize("name", ["ramp", "stop on a slope"])
@pytest.mark.parametrize(
    "change",
    [
        lambda log: {},
        lambda log: {"v": np.interp(log.time - 0.02, log.time, log["v"])},
        lambda log: {"a_x": 1.03 * log["a_x"]},
        lambda log: {"a_x": log["a_x"] + 0.02 * G},
        lambda log: {"v": 1.01 * log["v"]},
    ],
    ids=["nothing", "usual delay", "scale", "zero", "radius"],
)
def test_a_speed_in_time_is_left_alone(name, change):
    log = RUNS[name]
    assert not delay_of(changed(log, **change(log))).late


def test_a_late_speed_of_uncertain_delay_is_not_used():
    """A slow ramp bends v at the bite by so little that a slope which changes may do it, too."""
    slow = late(noisy(ramp(REAL), 1), 0.2)
    estimate = delay_of(slow)
    assert estimate.late
    assert not estimate.sharp
    assert abs(estimate.value - 0.2) < 2.0 * estimate.sigma
    assert signals(slow, CAR.rear.rolling_radius).v is None

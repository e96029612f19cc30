"""Logs over a bus: what is sent seldom, late or filtered is no fault of the car."""

from dataclasses import replace

import numpy as np
import pytest

from calib.diagnosis.proof.gap import CHANNELS, noises_of
from calib.diagnosis.search.clocks import DELAYS
from calib.run.copies import without_holds
from tests.support.explained import diagnosed
from tests.support.hidden.cases import draw
from tests.support.measuring_chain import Message, chained

V = CHANNELS.index("v")
LATE = {
    "p_mc": Message(100.0, 0.005),
    "a_x": Message(50.0, 0.02, corner=15.0),
    "omega": Message(100.0, 0.01),
    "v": Message(20.0, 0.06),
}


@pytest.mark.slow
def test_channels_that_are_late_are_named_as_that_together():
    case, rng = draw("none", 4402), np.random.default_rng(5)
    parts = (case.calibration, case.holdout)
    logs, held = (tuple(chained(log, LATE, rng) for log in part) for part in parts)
    found = diagnosed(replace(case, calibration=logs, holdout=held))
    assert found.verdict == "named"
    assert {effect.name for effect in found.effects} <= set(DELAYS)
    late = {effect.name: effect.parameters for effect in found.effects}
    # against the wheels, as all of them are late against p_mc besides
    apart = late["speed_delay"]["v_delay"].value
    if "wheel_speed_delay" in late:
        apart -= late["wheel_speed_delay"]["omega_delay"].value
    assert apart == pytest.approx(0.05, abs=0.006)
    # two poles of 15 Hz are a delay of 15 ms, and 20 ms come besides
    assert late["accelerometer_lag"]["filter_time"].value == pytest.approx(0.03, abs=0.015)


def test_the_noise_of_a_channel_is_that_of_its_values_however_seldom_they_are_sent():
    (log,) = draw("none", 4403, only=("hot_stop",)).holdout
    sent = without_holds(chained(log, {"v": Message(20.0)}, np.random.default_rng(1)))
    # between two values noise is averaged: to two thirds of its variance, on the mean
    assert noises_of([sent])[V] == pytest.approx(np.sqrt(2.0 / 3.0) * 0.02, rel=0.2)
    assert noises_of([log])[V] == pytest.approx(0.02, rel=0.1)

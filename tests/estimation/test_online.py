"""Answers of an ECU in an estimate: sensors that fail as they read, and gaps of a log."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.car.effects.effects import Effects
from calib.estimation.estimator import estimate
from calib.estimation.reasons import Reason
from calib.estimation.validate import validate
from calib.run.blocks import samples_of_block
from tests.support.made_runs import changed
from tests.support.reference_car import CAR, REAL, WET, noisy, stop, without

PADS = 0.35, 0.32
EFFECTS = {
    "accelerometer_lag": {"filter_time": 0.12, "filter_bend": 0.0},
    "pitch_coupling": {"elastic_share": 0.4, "natural_frequency": 8.2, "damping": 0.3,
                       "pitch_gradient": 0.03},
    "hydraulic_delay": {"delay": 0.08},
}  # fmt: skip


@pytest.mark.parametrize("effect", EFFECTS)
def test_sensors_are_judged_as_they_read_not_behind_known_effects(fitted, effect):
    car = replace(CAR, effects=Effects({effect: EFFECTS[effect]}))
    log = noisy(stop(WET), 5)
    rough = log["a_x"] + np.random.default_rng(1).normal(0.0, 0.3, log.time.size)
    glitch = np.where(np.arange(log.time.size) % 397 == 300, 300e5, log["p_mc"])
    frozen = np.where(log.time < log.time[0] + 1.0, log["a_x"], log["a_x"][0])
    channels = {}, {"a_x": rough}, {"a_x": frozen}, {"p_mc": glitch}
    fine, rough, frozen, glitch = (estimate(fitted, changed(log, **x), car) for x in channels)
    assert not np.any(rough.ecu.step.reason == Reason.FAULT)
    assert not np.any(frozen.ecu.valid)
    is_valid = fine.ecu.valid & glitch.ecu.valid
    assert is_valid.sum() > 100
    for x, y in ((fine.ecu.pads_f, glitch.ecu.pads_f), (fine.ecu.torque_f, glitch.ecu.torque_f)):
        assert y.value[is_valid] == pytest.approx(x.value[is_valid], rel=0.05)


@pytest.mark.parametrize("left_out", [(), ("v",)])
@pytest.mark.parametrize("gap", [0.15, 0.6, 1.2])
def test_behind_a_gap_of_the_log_the_pads_are_within_their_bounds(fitted, gap, left_out):
    log = without(noisy(stop(replace(REAL, pads=lambda t: PADS)), 6), *left_out)
    start = log.time[np.argmax(log["p_mc"] > 10e5)] + 0.6
    is_logged = (log.time < start) | (log.time > start + gap)
    channels = {name: x[is_logged] for name, x in log.channels.items()}
    truth = {name: x[is_logged] for name, x in log.truth.items()}
    (result,) = validate(fitted, [replace(log, channels=channels, truth=truth)])
    assert result.passed
    assert {warning.code for warning in result.all_warnings} <= {"clock_gaps", "level_changed"}
    e = result.estimate
    assert np.array_equal(e.time, log.time[is_logged])
    for answer in (e.ecu, e.best):
        late = answer.valid & (e.time > start + gap)
        assert late.sum() > 100
        for pads, true in ((answer.pads_f, PADS[0]), (answer.pads_r, PADS[1])):
            assert np.all((pads.lower < true) & (true < pads.upper) | ~late)
            assert pads.value[late] == pytest.approx(true, rel=0.08)


def test_a_value_that_is_held_for_a_tenth_of_a_second_is_no_fault(fitted):
    log = noisy(stop(WET), 5)
    for hold in (19, 20, 21, 25):
        slow = log["a_x"][np.arange(log.time.size) // hold * hold]
        e = estimate(fitted, changed(log, a_x=slow))
        assert not np.any(e.ecu.step.reason == Reason.FAULT)


def test_no_usual_clock_is_where_the_length_of_a_block_turns_over():
    for rate in (40, 50, 60, 100, 125, 150, 200, 250, 333, 500, 1000):
        lengths = {samples_of_block((1.0 + x) / rate) for x in (-3e-3, 0.0, 3e-3)}
        assert len(lengths) == 1 or rate > 200


def test_a_log_without_a_block_is_refused(fitted):
    log = noisy(stop(WET), 5)
    with pytest.raises(LogError):
        estimate(fitted, replace(log, channels={k: x[:5] for k, x in log.channels.items()}))

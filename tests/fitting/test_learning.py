"""What stops tell of a car: a plant says what is true, and no few draws carry the weight."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.fitting.fit import fit
from calib.fitting.learning import learn, log_likelihood
from calib.fitting.posterior import posterior
from calib.table.table import Value
from tests.support.drawn_cars import one_car
from tests.support.reference_car import CAR, IDEAL, noisy, prepared, ramp, stop, with_ratio, without

RATIO = 1.06
PLANT = with_ratio(IDEAL, RATIO)
SOFT, HARD = 12e5, 56e5
"""Pressures that brake with 0.17 and 0.8 g; the peak of the plant's tyres is 0.9."""


@pytest.fixture(scope="module")
def drawn():
    return posterior(CAR, [prepared(noisy(ramp(PLANT), 1))], Value(0.0, 0.07), draws=512)


def of_stop(pressure, seed, plant=PLANT):
    return noisy(stop(plant, pressure, f"stop_{seed}"), seed)


@pytest.mark.parametrize(("pressure", "least", "most"), [(SOFT, 0.0, 1.0), (HARD, 3.0, 100.0)])
def test_a_hard_stop_tells_the_peak_and_a_soft_one_does_not(pressure, least, most):
    cars = one_car("magic_sharp", peak=np.array([0.9, 1.4]), log_pad_ratio=np.log(RATIO))
    by_peak = log_likelihood(CAR, cars, prepared(stop(PLANT, pressure)))
    assert least < by_peak[0] - by_peak[1] < most


def test_the_truth_stays_inside_and_many_draws_remain(drawn):
    stops = [prepared(of_stop(p, i)) for i, p in enumerate((20e5, 35e5, 50e5))]
    learnt, remarks = learn(CAR, drawn, stops)
    low, high = np.quantile(learnt.log_pad_ratio, [0.025, 0.975])
    assert low < np.log(RATIO) < high
    assert np.unique(learnt.peak).size > 0.4 * np.unique(drawn.peak).size
    assert len(remarks) == 1 + len(stops)


@pytest.mark.parametrize("count", [1, 3])
def test_stops_that_contradict_the_ramp_leave_no_few_draws(drawn, count):
    """Rear tyres that lost a third of their stiffness since: no list has them."""
    other = replace(PLANT, rear_stiffness=0.65)
    learnt, _ = learn(CAR, drawn, [prepared(of_stop(40e5, i, other)) for i in range(count)])
    assert np.unique(learnt.peak).size > 0.4 * np.unique(drawn.peak).size


def test_a_stop_that_nothing_explains_or_without_a_speed_tells_nothing(drawn):
    """Rear wheels that turn 5 % slower in the second half, at one pressure and deceleration."""
    log = of_stop(30e5, 1)
    later = np.where(log.time > 4.0, 0.95, 1.0)
    slow = {wheel: log[wheel] * later for wheel in ("omega_rl", "omega_rr")}
    for odd in (replace(log, channels=log.channels | slow), without(log, "v")):
        learnt, remarks = learn(CAR, drawn, [prepared(odd)])
        assert learnt is drawn
        assert len(remarks) == 1


def test_a_log_that_brakes_too_fast_for_a_ramp_is_a_stop_beside_one():
    logs = [replace(noisy(ramp(PLANT), 1), digest="a"), replace(of_stop(30e5, 2), digest="b")]
    table = fit(CAR, logs)
    roles = {log.name: log.role for log in table.provenance.logs}
    assert roles == {"ramp": "ramp", "stop_2": "stop"}
    assert table.provenance.fitted_log_of(logs[1])
    with pytest.raises(LogError):
        fit(CAR, logs[1:])
    backward = {**logs[1].channels, "a_x": -logs[1]["a_x"]}
    with pytest.raises(LogError):
        fit(CAR, [logs[0], replace(logs[1], channels=backward)])

"""A log through the step, on the independent plant: causal, finite, right, the same for an ECU."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.names import WHEELS
from calib.estimation.estimator import estimate
from tests.support.reference_car import CAR, REAL, WET, cut, noisy, stop, with_pads, without

ANSWERS = ("best", "ecu")


@pytest.fixture(scope="module")
def wet():
    return noisy(stop(WET), 3)


@pytest.fixture(scope="module")
def result(fitted, wet):
    return estimate(fitted, wet)


def settled_samples(e):
    """Braked samples above 3 m/s, 0.3 s after the bite."""
    since = e.time - e.time[np.flatnonzero(e.braked)[0]]
    return e.braked & (e.signals.speed > 3.0) & (since > 0.35)


def level_of(front, rear):
    """Brake force of pads over that of the vehicle file's."""
    gains = [a.torque_gain * a.pad_friction for a in (CAR.front, CAR.rear)]
    changed = [front / CAR.front.pad_friction, rear / CAR.rear.pad_friction]
    return sum(g * x for g, x in zip(gains, changed, strict=True)) / sum(gains)


def inside(x, true, is_settled):
    return float(np.mean(((x.lower <= true) & (true <= x.upper))[is_settled]))


@pytest.mark.parametrize("name_of_answer", ANSWERS)
def test_level_pads_and_ratio_are_in_their_bounds(result, name_of_answer):
    answer, is_settled = getattr(result, name_of_answer), settled_samples(result)
    assert inside(answer.level, level_of(0.31, 0.27), is_settled) > 0.9
    assert inside(answer.pads_f, 0.31, is_settled) > 0.9
    assert inside(answer.pads_r, 0.27, is_settled) > 0.9
    assert inside(answer.ratio, 0.31 / 0.27, is_settled) > 0.9
    assert inside(answer.change_f, 0.31 / 0.38, is_settled) > 0.9
    assert np.mean(answer.level.value[is_settled]) == pytest.approx(level_of(0.31, 0.27), rel=0.02)
    assert np.mean(answer.valid[is_settled]) > 0.9


@pytest.mark.parametrize("name_of_answer", ANSWERS)
def test_torques_add_up_to_the_level(result, wet, name_of_answer):
    answer, is_settled = getattr(result, name_of_answer), settled_samples(result)
    total = 2.0 * (answer.torque_f.value + answer.torque_r.value)
    assert answer.torque_sum.value == pytest.approx(total)
    true = sum(wet.truth[f"true_Tb_{w}"] for w in WHEELS)
    assert np.mean(total[is_settled] / true[is_settled]) == pytest.approx(1.0, abs=0.02)
    nominal = sum(2.0 * a.torque_gain * a.pad_friction for a in (CAR.front, CAR.rear))
    assert total[is_settled] == pytest.approx(
        (nominal * answer.level.value * wet["p_mc"])[is_settled]
    )


@pytest.mark.parametrize("name_of_answer", ANSWERS)
def test_every_settled_sample_has_an_answer(fitted, wet, name_of_answer):
    for log in (wet, without(wet, "v"), cut(wet, 1.4)):
        e = estimate(fitted, log)
        for name, x in getattr(e, name_of_answer).columns().items():
            assert np.all(np.isfinite(x[settled_samples(e)])), name


@pytest.mark.parametrize("logged", ["with v", "without v"])
def test_brakes_that_follow_late_are_found(fitted, logged):
    log = noisy(stop(replace(REAL, hydraulic_lag=0.15)), 3)
    log = log if logged == "with v" else without(log, "v")
    e = estimate(fitted, log)
    late = settled_samples(e) & (e.time > 2.5)
    assert inside(e.best.level, 1.0, late) > 0.9
    assert inside(e.best.pads_f, 0.38, late) > 0.85


def test_pads_that_are_unlike_are_told_with_a_speed(fitted):
    log = noisy(stop(with_pads(REAL, 0.28, 0.38)), 3)
    e = estimate(fitted, log)
    is_settled = settled_samples(e)
    assert inside(e.best.ratio, 0.28 / 0.38, is_settled) > 0.85
    assert e.best.ratio.value[is_settled][-1] < 0.9

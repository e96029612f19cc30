"""Other methods than the estimate: their errors, and none where a method does not apply."""

from dataclasses import replace

import numpy as np
import pytest

from calib.estimation.baselines import METHODS, mean_gain
from calib.estimation.estimator import estimate
from calib.estimation.validate import validate
from calib.fitting.fit import fit
from tests.support.reference_car import CAR, IDEAL, REAL, noisy, ramp, stop, with_pads, without

UNSTABLE = {name for name in METHODS if name.startswith("gradient")}


@pytest.fixture(scope="module")
def ideal():
    return fit(CAR, [ramp(IDEAL)])


def test_a_law_that_is_unstable_has_no_error(fitted):
    """gamma u^2 dt = 8/s (p/20 bar)^2 dt is 2.45 at 70 bar and 40 Hz; no wheel locks."""
    log = stop(with_pads(REAL, 0.2, 0.2), 70e5, duration=6.0, rate=40.0)
    (result,) = validate(fitted, [noisy(log, 2)])
    assert {*METHODS} - {*result.baselines} == UNSTABLE
    e = result.estimate
    for name in UNSTABLE:
        assert np.isnan(METHODS[name](e)[0]).all()
    assert np.mean(e.valid[e.braked & (e.signals.speed > 5.0)]) > 0.5


def test_errors_are_against_truth_or_the_speed(fitted):
    log = noisy(stop(), 3)
    blind = replace(log, truth={})
    by_truth, by_speed, by_nothing = validate(fitted, [log, blind, without(blind, "v")])
    assert set(by_truth.baselines) == {"estimate", "ecu", *METHODS}
    assert set(by_speed.baselines) == {"ecu", *METHODS}
    assert by_nothing.baselines == {}
    references = [result.compared_with for result in (by_truth, by_speed, by_nothing)]
    assert references == ["truth", "reference", "none"]
    e = by_speed.estimate
    off = (METHODS["nominal"](e)[1] / e.best.pads_r.value - 1.0)[e.valid]
    assert by_speed.baselines["nominal"][1] == pytest.approx(np.sqrt(np.mean(off**2)))


# Mean gain ---------------------------------------------------------------------------------------


def test_mean_gain_is_the_mean_weighted_by_force(ideal):
    """Pads 0.31/0.27 of nominal 0.38: one factor, with the gains A r of Table I as weights."""
    e = estimate(ideal, stop(with_pads(IDEAL, 0.31, 0.27), 30e5), CAR)
    front, rear = mean_gain(e)
    assert np.array_equal(front, rear)
    assert front[0] == 0.38
    weights = (28.84 * 130.9, 11.34 * 124.0)
    mean = np.average([0.31, 0.27], weights=weights)
    assert front[e.valid & (e.time > 3.0)] == pytest.approx(mean, rel=0.005)


# The law as it is written ------------------------------------------------------------------------

DT, N, ETA, TRUE = 0.005, 800, 1.003, (0.30, 0.45)


@pytest.mark.parametrize("pad", [0.38, 0.2])
def test_the_law_is_right_on_the_car_that_the_paper_describes(ideal, pad):
    """Constant pads alike, no noise, no drag, exact radii, the road of the ramp: within 2 %.

    What is left is the table's: D(eta) from another tyre curve than the plant's, 4 % off.
    """
    e = estimate(ideal, stop(with_pads(IDEAL, pad, pad), 25e5))
    last = int(np.flatnonzero(e.braked & (e.signals.speed > 3.0))[-1])
    pads = [float(axle[last]) for axle in METHODS["gradient_paper"](e)]
    assert pads == pytest.approx((pad, pad), rel=0.02)

"""Tyres that differ front to rear, and radii that fall under load: the intervals hold the truth."""

from dataclasses import replace

import numpy as np
import pytest

from calib.estimation.estimator import estimate
from calib.fitting.fit import fit
from calib.table.invariants import violations
from tests.support.reference_car import CAR, REAL, WET, covered, noisy, ramp, stop, with_ratio

CARS = {"rear 10 % stiffer": {"rear_stiffness": 1.1}, "radius falls": {"radius_load": 0.004}}


@pytest.fixture(scope="module", params=CARS)
def runs(request):
    """Return how a car differs from its file, its table, and the estimate of a stop."""
    unlike = CARS[request.param]
    table = fit(CAR, [noisy(ramp(replace(REAL, **unlike)), 0)])
    return unlike, table, estimate(table, noisy(stop(replace(WET, **unlike)), 10))


def test_the_ramp_gives_pads_and_tyres_within_their_intervals(runs):
    unlike, table, _ = runs
    c, draws = table.calibration, table.draws
    for pads in (c.pad_friction_f, c.pad_friction_r):
        assert abs(pads.value - 0.38) < 3.0 * pads.sigma
    ratio, r = np.log(unlike.get("rear_stiffness", 1.0)), unlike.get("radius_load", 0.0)
    tyres = np.log(draws.compliance_f / draws.compliance_r)
    for x, true in ((tyres, ratio), (draws.radius_load, r)):
        assert abs(np.mean(x) - true) < 3.0 * np.std(x)


def test_intervals_of_a_stop_hold_the_true_pads(runs):
    assert runs[2].valid.sum() > 100
    assert np.mean(covered(runs[2], 0.31, 0.27)) >= 0.9


def test_pads_and_tyres_that_differ_against_each_other_are_within_the_interval():
    """They show in no log, which is that of a car as declared; the interval includes them."""
    pads = with_ratio(replace(REAL, rear_stiffness=np.exp(-0.09)), np.exp(0.09))
    table = fit(CAR, [noisy(ramp(pads), 0)])
    ratio = table.calibration.pad_log_ratio
    assert abs(ratio.value - 0.09) < 2.0 * ratio.sigma
    assert violations(table) == ()

"""What tells the axles of a car near ideal balance, by the independent plant."""

from dataclasses import replace

import numpy as np
import pytest

from calib.car.bias import pressure_per_g
from calib.estimation.estimator import estimate
from calib.estimation.exchanged import exchanged
from calib.estimation.settings import SETTINGS
from calib.estimation.validate import validate
from calib.fitting.fit import fit
from tests.support.reference_car import CAR, REAL, balanced, noisy, ramp, stop, swapped, without

NEAR = balanced(CAR, 0.42)
"""Eta of the car rises by 0.1 % at most, and is 1 again at 0.42 g."""

PLANT = replace(REAL, vehicle=NEAR)


@pytest.fixture(scope="module")
def table():
    return fit(NEAR, [noisy(ramp(PLANT, 0.07 * pressure_per_g(NEAR)), 1)])


def weighed(table, log):
    return exchanged(estimate(table, log))


@pytest.mark.parametrize(("z", "logged"), [(0.4, "with v"), (0.2, "without v")])
def test_a_stop_says_which_axle_is_which(table, z, logged):
    """The other way round it says the opposite, and the pads that the stop has as it is."""
    log = noisy(stop(PLANT, z * pressure_per_g(NEAR)), 5)
    log = log if logged == "with v" else without(log, "v")
    right, wrong = weighed(table, log), weighed(table, swapped(log))
    assert right.log_odds < 2.0 * SETTINGS.axles_doubt
    assert wrong.log_odds > 10.0
    assert wrong.log_pad_ratio[1] == pytest.approx(right.log_pad_ratio[0], abs=0.05)


def test_validate_names_swapped_axles_where_eta_hardly_rises(table):
    log = noisy(stop(PLANT, 0.4 * pressure_per_g(NEAR)), 5)
    clean, other = validate(table, [log, swapped(log)])
    assert clean.passed
    assert not clean.warnings
    assert not other.passed
    assert not np.any(other.estimate.valid)
    (warning,) = (w for w in other.warnings if w.code == "axles_exchanged")
    assert "swapped" in warning.causes[0]

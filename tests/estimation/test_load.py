"""A passenger whom nobody stated, in a plant: the interval of the stop leaves room for one."""

from dataclasses import replace

import pytest

from calib.estimation.estimator import estimate
from calib.estimation.load import USUAL, mean_square_of_load, with_load
from calib.estimation.validate import validate
from tests.support.reference_car import CAR, REAL, held, noisy, stop, with_pads

PRESSURE = 28e5
WEAK = (0.30, 0.29)


def loaded(share, pads=None):
    """A stop of the car with more mass, with the pads of the ramp unless given."""
    plant = replace(REAL, vehicle=replace(CAR, mass=CAR.mass * (1.0 + share)))
    return stop(plant if pads is None else with_pads(plant, *pads), PRESSURE)


@pytest.mark.parametrize(("share", "pads"), [(0.0, WEAK), (0.055, None), (0.055, WEAK)])
def test_intervals_hold_with_a_passenger(fitted, share, pads):
    (result,) = validate(fitted, [noisy(loaded(share, pads), 7)])
    assert min(held(result.estimate, *(pads or ()))) > 0.75
    assert result.figures["valid_share"] > 0.8


def test_a_stated_mass_leaves_nothing_open(fitted):
    e = estimate(fitted, noisy(loaded(0.05), 3))
    assert with_load(e, stated=True) is e
    assert with_load(e, stated=False).front.upper[e.valid].mean() > e.front.upper[e.valid].mean()


def test_pads_that_have_changed_hide_a_load():
    """It is as likely as before; and one that is far from any load's size is none."""
    assert mean_square_of_load(-0.6, 0.01) == pytest.approx(0.1 * USUAL**2, rel=0.01)
    assert mean_square_of_load(0.0, 0.01) < 0.05 * 0.1 * USUAL**2 / 0.1
    assert mean_square_of_load(-0.06, 0.01) > 0.4 * 0.06**2

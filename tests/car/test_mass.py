"""A stated mass: what it changes of a car, what it leaves, and what is said of it."""

from dataclasses import replace

import numpy as np
import pytest

from calib.base.errors import VehicleError
from calib.car.effects.effects import Effects
from calib.car.forces import axle_loads
from calib.car.mass import mass_used, weighed
from tests.support.reference_car import CAR

UNKNOWN = replace(CAR, mass_tolerance=0.03)


def test_loads_grow_with_the_mass_and_the_centre_of_gravity_stays():
    heavy = weighed(CAR, 2000.0)
    z = np.array([0.0, 0.4])
    for now, then in zip(axle_loads(heavy, z), axle_loads(CAR, z), strict=True):
        assert now == pytest.approx(then * 2000.0 / 1744.0)
    assert replace(heavy, mass=CAR.mass) == CAR


def test_what_was_weighed_is_known_to_half_a_percent_or_as_the_file_says():
    assert weighed(UNKNOWN, 2000.0).mass_tolerance == 0.005
    assert weighed(replace(CAR, mass_tolerance=0.002), 2000.0).mass_tolerance == 0.002


def test_a_known_error_of_the_mass_in_the_file_counts_no_more():
    known = Effects({"mass_error": {"mass_error": 0.1}, "road_grade": {"grade": 0.01}})
    assert weighed(replace(CAR, effects=known), 2000.0).effects.names == ("road_grade",)


@pytest.mark.parametrize("factor", [0.45359237, 1.0 / 0.45359237, 0.1])
def test_pounds_written_as_kilograms_are_no_load_of_this_car(factor):
    with pytest.raises(VehicleError, match=r"times the 1744 kg of the vehicle file"):
        weighed(CAR, factor * CAR.mass)
    with pytest.raises(VehicleError, match="check number and unit"):
        mass_used(CAR, factor * CAR.mass)

"""Level and ratio of pads against the brake force of both axles (2)."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.table.budget import pad_levels, pad_scale
from tests.support.cars_of_a_line import car_table
from tests.support.tables import VEHICLE


def force(vehicle, mu_f, mu_r):
    """Brake force of both axles over pressure, (2) with both wheels."""
    axles = (vehicle.front, mu_f), (vehicle.rear, mu_r)
    per_face = (a.piston_area * a.effective_radius * mu / a.rolling_radius for a, mu in axles)
    return 2 * 2 * sum(per_face)  # two wheels with two faces each


@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_the_level_is_the_brake_force_of_both_axles_and_the_way_back_is_exact(level, ratio):
    pads = car_table(1, level=level, ratio=ratio).calibration
    levels = pad_levels(VEHICLE, pads)
    nominal = force(VEHICLE, VEHICLE.front.pad_friction, VEHICLE.rear.pad_friction)
    calibrated = force(VEHICLE, pads.pad_friction_f.value, pads.pad_friction_r.value)
    assert levels.level == pytest.approx(math.log(calibrated / nominal), abs=1e-12)
    assert levels.ratio == pytest.approx(ratio, abs=1e-12)
    assert math.log(pad_scale(VEHICLE, levels)) == pytest.approx(level, abs=1e-12)

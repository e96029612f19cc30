"""Budgets add up, advice follows from their parts; level and ratio of pads against (2)."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.plain import rows
from calib.table.budget import RAMP, STOP, advice_lines, axle_parts, level_and_ratio, pad_scale
from tests.support.cars_of_a_line import car_table
from tests.support.tables import VEHICLE

PARTS = [x for x in rows("budget.csv", "calib.table")[0] if x not in ("do", "budget")]
VARIANCES = st.dictionaries(st.sampled_from(PARTS), st.floats(0.0, 1e-2), max_size=len(PARTS))


@given(VARIANCES, VARIANCES)
def test_parts_add_up_to_the_variance(level, ratio):
    axles = axle_parts(VEHICLE, 0.1, level, ratio)
    squares = [sum(x**2 for x in parts.values()) for parts in axles]
    by_ratio = [math.sqrt(max(square - sum(level.values()), 0.0)) for square in squares]
    # an axle takes the share of the other axle in the brake force, and the shares make 1
    assert sum(by_ratio) == pytest.approx(math.sqrt(sum(ratio.values())), abs=1e-7)
    assert all(x > 0.0 for parts in axles for x in parts.values())


@pytest.mark.parametrize(
    ("kind", "lacks"), [(RAMP, ["ramp"]), (STOP, ["ramp", "resistance", "load_geometry"])]
)
def test_every_part_has_an_advice_of_its_own(kind, lacks):
    advice = rows("budget.csv", "calib.table")
    for part in set(PARTS) - {*lacks}:
        line = advice_lines([{part: 0.04}] * 2, kind)[0]
        useful = [row["do"] for row in advice if row["budget"] in ("", kind) and row[part]]
        assert line.startswith(tuple(useful)), part


def test_a_weighed_mass_needs_no_scale():
    other_parts = {"tyres": 0.03, "unlike_pads": 0.01}
    for mass, advised in ((0.005, False), (0.02, False), (0.03, True), (0.0329, True)):
        lines = advice_lines([{"mass": mass, **other_parts}] * 2)
        assert any("--mass" in line for line in lines) == advised


def force(mu_f, mu_r):
    """Brake force of both axles over pressure, (2) with two wheels of two faces each."""
    axles = (VEHICLE.front, mu_f), (VEHICLE.rear, mu_r)
    per_face = (a.piston_area * a.effective_radius * mu / a.rolling_radius for a, mu in axles)
    return 2 * 2 * sum(per_face)


@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_the_level_is_the_brake_force_of_both_axles_and_the_way_back_is_exact(level, ratio):
    pads = car_table(1, level=level, ratio=ratio).calibration
    levels = level_and_ratio(VEHICLE, pads)
    nominal = force(VEHICLE.front.pad_friction, VEHICLE.rear.pad_friction)
    calibrated = force(pads.pad_friction_f.value, pads.pad_friction_r.value)
    assert levels.level == pytest.approx(math.log(calibrated / nominal), abs=1e-12)
    assert levels.ratio == pytest.approx(ratio, abs=1e-12)
    assert math.log(pad_scale(VEHICLE, levels)) == pytest.approx(level, abs=1e-12)

"""Budgets add up, and advice follows from their parts."""

import math

import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.plain import rows
from calib.table.budget import RAMP, STOP, advice_lines, axle_parts
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


def test_a_mass_that_was_stated_needs_no_scale():
    other_parts = {"tyres": 0.03, "unlike_pads": 0.01}
    for mass, advised in ((0.005, False), (0.02, False), (0.03, True), (0.0329, True)):
        lines = advice_lines([{"mass": mass, **other_parts}] * 2)
        assert any("--mass" in line for line in lines) == advised

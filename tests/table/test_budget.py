"""Budgets as numbers and words, and what is known of tables that have none."""

import math
from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.table.budget import (
    PARTS,
    AxleBudget,
    advice_lines,
    axle_budget,
    level_of,
    pad_levels,
    pad_scale,
    pads_budget,
    summary,
)
from calib.table.table import TableBudget, Value
from tests.support.cars_of_a_line import car_table
from tests.support.tables import VEHICLE, from_content, made_table

VARIANCES = st.dictionaries(st.sampled_from(PARTS), st.floats(0.0, 1e-2), max_size=len(PARTS))


@given(VARIANCES, VARIANCES, st.floats(0.0, 1.0))
def test_parts_add_up_to_the_variance(level, ratio, lever):
    budget = axle_budget(0.4, (1.0, level), (lever**2, ratio))
    total = sum(level.values()) + lever**2 * sum(ratio.values())
    assert budget.sigma**2 == pytest.approx(total, rel=1e-12, abs=1e-300)
    assert math.sqrt(sum(x**2 for x in budget.relative.values())) == pytest.approx(budget.sigma)
    assert list(budget.relative.values()) == sorted(budget.relative.values(), reverse=True)


def test_summary_names_the_largest_part_and_what_to_do():
    front = AxleBudget(0.40, {"zeros": 1e-6, "mass": 9e-4})
    rear = AxleBudget(0.38, {"tyres": 4e-4, "mass": 1e-4})
    told = summary(front, rear)
    assert told["front"] == pytest.approx({"mass": 0.03, "zeros": 0.001})
    assert told["rear"] == pytest.approx({"tyres": 0.02, "mass": 0.01})
    assert told["largest"]["front"]["part"] == "mass"
    assert "mass_tolerance" in told["largest"]["front"]["do"]
    assert told["largest"]["rear"]["part"] == "tyres"
    assert len(advice_lines([front, rear, front])) == 2


OLD = replace(
    made_table(),
    calibration=replace(
        made_table().calibration, pad_scale=Value(1.0, 0.04), pad_log_ratio=Value(0.0, 0.0)
    ),
)


def test_of_a_table_without_a_budget_only_the_mass_is_known():
    assert level_of(OLD) == pytest.approx({"mass": 9e-4, "ramp": 16e-4 - 9e-4})
    for axle in pads_budget(OLD):
        assert axle.sigma == pytest.approx(0.04)


def test_a_budget_comes_back_from_the_record():
    one = TableBudget(
        {"mass": 0.03}, {"tyres": 0.02}, {"mass": 9e-4}, {"noise": ((1e-4, 0.0), (0.0, 2e-4))}
    )
    held = replace(OLD, budget=one)
    assert held.digest != OLD.digest
    read = from_content(*held.content())
    assert read.budget == one
    assert read.digest == held.digest
    assert [axle.relative for axle in pads_budget(read)] == [
        pytest.approx({"mass": 0.03}),
        pytest.approx({"tyres": 0.02}),
    ]


def force(vehicle, mu_f, mu_r):
    """Brake force of both axles over pressure, (2) with both wheels."""
    axles = zip((vehicle.front, vehicle.rear), (mu_f, mu_r), strict=True)
    return sum(
        2 * 2 * a.piston_area * a.effective_radius * mu / a.rolling_radius for a, mu in axles
    )


@given(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
def test_the_level_is_the_brake_force_of_both_axles_and_the_way_back_is_exact(level, ratio):
    pads = car_table(1, level=level, ratio=ratio).calibration
    found = pad_levels(VEHICLE, pads)
    nominal = force(VEHICLE, VEHICLE.front.pad_friction, VEHICLE.rear.pad_friction)
    told = force(VEHICLE, pads.pad_friction_f.value, pads.pad_friction_r.value)
    assert found.level == pytest.approx(math.log(told / nominal), abs=1e-12)
    assert found.ratio == pytest.approx(ratio, abs=1e-12)
    assert math.log(pad_scale(VEHICLE, found)) == pytest.approx(level, abs=1e-12)


def test_level_and_ratio_are_those_of_the_vehicle_file():
    front = replace(VEHICLE.front, pad_friction=2.0 * VEHICLE.front.pad_friction)
    rear = replace(VEHICLE.rear, pad_friction=2.0 * VEHICLE.rear.pad_friction)
    found = pad_levels(replace(VEHICLE, front=front, rear=rear), car_table(1).calibration)
    assert (found.level, found.ratio) == (pytest.approx(-math.log(2.0)), pytest.approx(0.0))

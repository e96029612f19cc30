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
    axle_budgets,
    level_of,
    pads_budget,
    summary,
)
from calib.table.table import TableBudget, Value
from tests.support.cars_of_a_line import car_table
from tests.support.tables import VEHICLE, from_content, made_table

VARIANCES = st.dictionaries(st.sampled_from(PARTS), st.floats(0.0, 1e-2), max_size=len(PARTS))


@given(VARIANCES, VARIANCES)
def test_parts_add_up_to_the_variance(level, ratio):
    budgets = axle_budgets(VEHICLE, car_table(1).calibration, level, ratio)
    levers = [math.sqrt(max(b.sigma**2 - sum(level.values()), 0.0)) for b in budgets]
    # each axle by the share of the other one: together they are one
    assert sum(levers) == pytest.approx(math.sqrt(sum(ratio.values())), abs=1e-7)
    for budget in budgets:
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

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.table.compare import diff
from tests.support.tables import made_table


def gap_of(difference, curve):
    return next(gap for gap in difference.curves if gap.curve == curve)


def test_a_table_differs_in_nothing_from_itself(table):
    difference = diff(table, made_table())
    assert difference.identical
    assert [gap.curve for gap in difference.curves] == ["D", "f1", "f2", "g"]
    assert all(gap.in_bands == 0.0 for gap in difference.curves)


@given(st.floats(20.0, 40.0), st.floats(20.0, 40.0), st.integers(5, 60), st.integers(5, 60))
def test_stiffness_gap_is_its_closed_form(first, second, rows_a, rows_b):
    # D = C (eta - 1): the gap is (C_b - C_a) (eta - 1), largest at the end x = 0.005; its mean
    # square over the axis is that squared over 3; the half-width is 2 (eta - 1) in both tables.
    gap = gap_of(diff(made_table(first, rows=rows_a), made_table(second, rows=rows_b)), "D")
    assert gap.largest == pytest.approx((second - first) * 0.005, abs=1e-12)
    assert gap.rms == pytest.approx(abs(second - first) * 0.005 / np.sqrt(3.0), abs=1e-12)
    assert gap.in_bands == pytest.approx(abs(second - first) / np.sqrt(8.0), rel=1e-6, abs=1e-9)


def test_only_the_common_axis_counts(table):
    longer = made_table()
    shifted = replace(longer.tyre, slip=longer.tyre.slip + 0.004)
    gap = gap_of(diff(table, replace(longer, tyre=shifted)), "g")
    assert (gap.start, gap.end) == pytest.approx((0.004, 0.01))
    assert gap.largest == pytest.approx(-27.0 * 0.004)


def test_curves_without_a_common_axis_are_named_apart(table):
    moved = replace(table.tyre, slip=table.tyre.slip + 0.02)
    difference = diff(table, replace(table, tyre=moved))
    assert difference.apart == ("g",)
    assert not difference.identical


def test_a_gap_without_a_band_is_infinitely_many_bands(table):
    def bare(table):
        D = table.difference
        return replace(table, difference=replace(D, lower=D.D, upper=D.D))

    assert gap_of(diff(bare(table), bare(made_table(28.0))), "D").in_bands == float("inf")


def test_changes_are_sorted_into_sections(table):
    calibration = replace(
        table.calibration, pad_scale=replace(table.calibration.pad_scale, value=1.1)
    )
    other = replace(
        table,
        calibration=calibration,
        quality={"rms": 0.0021, "coverage": 0.9},
        provenance=replace(table.provenance, logs=table.provenance.logs[:1]),
    )
    changes = diff(table, other).changes
    assert set(changes) == {"calibration", "quality", "provenance"}
    (pad_scale,) = changes["calibration"]
    assert (pad_scale.key, pad_scale.a, pad_scale.b) == ("pad_scale.value", "1.05", "1.1")
    (coverage,) = changes["quality"]
    assert (coverage.key, coverage.a, coverage.b) == ("coverage", None, "0.9")
    assert {change.key.split(".csv")[0] for change in changes["provenance"]} == {"logs.coast"}


def test_logs_of_one_name_are_kept_apart(table):
    twice = replace(table.provenance, logs=(table.provenance.logs[0],) * 2)
    once = replace(table.provenance, logs=(table.provenance.logs[0],))
    assert (
        "provenance"
        in diff(replace(table, provenance=once), replace(table, provenance=twice)).changes
    )

"""Places on a bar, by hand."""

import pytest

from calib.show.judged import bar


def test_a_range_with_a_warning_inside():
    # -0.2 to 0.2 with room of 0.3 * 0.4 on both sides: -0.32 to 0.32
    found = bar([0.0, 0.2], (-0.2, 0.2), (-0.1, 0.1), "x")
    assert found.marks == pytest.approx((50.0, 81.25))
    assert found.warning == pytest.approx((18.75, 62.5))
    assert found.passed == pytest.approx((34.375, 31.25), abs=0.01)


def test_one_open_end_begins_at_zero():
    most = bar([0.05], (None, 0.1), (None, None), "x")
    assert most.marks == pytest.approx((100.0 * 0.05 / 0.13,), abs=0.01)
    assert most.passed[0] == 0.0
    assert most.passed[1] == pytest.approx(100.0 / 1.3, abs=0.01)
    least = bar([0.9], (0.7, None), (0.8, None), "x")
    assert sum(least.passed) == pytest.approx(100.0)
    assert least.warning[0] == pytest.approx(100.0 * 0.7 / 0.99, abs=0.01)


def test_what_is_beyond_the_bar_is_at_its_end():
    assert bar([9.0], (None, 0.1), (None, None), "x").marks == (100.0,)


def test_nothing_to_draw():
    assert bar([None], (0.0, 1.0), (None, None), "x") is None
    assert bar([1.0], (None, None), (None, None), "x") is None

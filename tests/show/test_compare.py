import numpy as np
import pytest

from calib.show import compare
from calib.show.style import FRONT, REAR
from tests.support.plot_lines import axes, labels, line
from tests.support.tables import C, made_table

FIRST, SECOND = made_table(), made_table(28.0, rows=31)


def line_of(ax, colour):
    """x and y of the longest line of a colour."""
    found = [one for one in ax.get_lines() if one.get_color() == colour]
    return max((one.get_data() for one in found), key=lambda data: len(data[0]))


def one_curve(table):
    d = table.difference
    return 100.0 * (d.eta - 1.0), d.D, d.lower, d.upper


def test_the_gap_of_two_straight_lines_is_straight():
    x, gap, half = compare.gap(one_curve(FIRST), one_curve(SECOND))
    assert gap == pytest.approx((28.0 - C) * x / 100.0)
    # both bands are +- 2 (eta - 1)
    assert half == pytest.approx(np.sqrt(2.0) * 2.0 * x / 100.0)


def test_only_the_common_range_counts():
    x, y, lower, upper = one_curve(FIRST)
    shifted = x + 0.3, y, lower, upper
    found, _, _ = compare.gap((x, y, lower, upper), shifted)
    assert found[0] == pytest.approx(0.3)
    assert found[-1] == pytest.approx(x[-1])
    assert compare.gap((x, y, lower, upper), (x + 9.0, y, lower, upper))[0].size == 0


def test_tables_that_do_not_meet_say_so():
    x, y, lower, upper = one_curve(FIRST)
    ax = axes()
    both = {"D": ((x, y, lower, upper), (x + 9.0, y, lower, upper))}
    compare.differences(ax, both, ("D",), {})
    assert [text.get_text() for text in ax.texts] == ["no common range"]


def test_both_tables_are_drawn_with_their_bands():
    sheet = compare.sheet(FIRST, SECOND, "sedan@1", "sedan@2")
    (ax,) = sheet.figure("f1-f2").axes
    assert np.array_equal(line(ax, "$f_1$ sedan@1")[1], FIRST.paper.f1)
    assert np.array_equal(line(ax, "$f_2$ sedan@2")[1], SECOND.paper.f2)
    assert len(ax.collections) == 4
    (ax,) = sheet.figure("f1-f2-gap").axes
    x, y = line_of(ax, FRONT["color"])
    # f1 = D F_zr/F_z with the load of z = 60 (eta - 1); linear between rows
    rear = (1.1556 - 60.0 * x / 100.0 * 0.615) / 2.805
    assert y == pytest.approx((28.0 - C) * x / 100.0 * rear, abs=2e-5)


def test_the_sheet_says_which_is_which():
    sheet = compare.sheet(FIRST, SECOND, "sedan@1", "sedan@2")
    assert sheet.title == "sedan@1 and sedan@2"  # as they were given
    assert sheet.name == "sedan@1_sedan@2"
    assert sheet.result.startswith("Equal within bands")
    page = sheet.overview()
    assert labels(page.axes[2]) == ["$D$ sedan@1", "$D$ sedan@2"]
    assert "sedan@2 less sedan@1" in page.axes[3].get_title(loc="left")
    assert FIRST.digest[:16] in sheet.note
    assert SECOND.digest[:16] in sheet.note


def test_a_colour_is_a_quantity_and_a_line_style_is_a_table():
    (ax,) = compare.sheet(FIRST, SECOND, "a@1", "b@1").figure("f1-f2").axes
    lines = {one.get_label(): one for one in ax.get_lines()}
    for table in ("a@1", "b@1"):
        assert lines[f"$f_1$ {table}"].get_color() == FRONT["color"]
        assert lines[f"$f_2$ {table}"].get_color() == REAR["color"]
    for f in ("$f_1$", "$f_2$"):
        assert lines[f"{f} a@1"].get_linestyle() != lines[f"{f} b@1"].get_linestyle()


def test_the_largest_difference_is_named_with_its_place():
    (ax,) = compare.sheet(FIRST, SECOND, "a@1", "b@1").figure("difference-gap").axes
    # D = C (eta - 1): 28 against 27 at 0.5 % is 0.005 more, 1/27; the bands are 0.014
    assert labels(ax) == ["$D$: +0.0050 (+3.7\u00a0%) at 0.50\u00a0%, within the bands"]
    (mark,) = [one for one in ax.get_lines() if one.get_marker() == "o"]
    assert mark.get_xydata()[0] == pytest.approx([0.5, 0.005])
    far = compare.sheet(FIRST, made_table(60.0), "a@1", "b@1")
    assert labels(far.figure("difference-gap").axes[0])[0].endswith("outside the bands")
    assert far.result.startswith("Different")

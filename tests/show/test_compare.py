import numpy as np
import pytest

from calib.show import compare
from tests.support.plot_lines import line, panel
from tests.support.tables import C, made_table

FIRST, SECOND = made_table(), made_table(28.0, rows=31)


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


def test_both_tables_are_drawn_and_the_second_less_the_first():
    sheet = compare.sheet(FIRST, SECOND, "sedan@1", "sedan@2")
    curves = panel(sheet, "f1-f2")
    assert np.array_equal(line(curves, "$f_1$ sedan@1")[1], FIRST.paper.f1)
    assert np.array_equal(line(curves, "$f_2$ sedan@2")[1], SECOND.paper.f2)
    assert all(one.band for one in curves.lines)
    x, y = line(panel(sheet, "f1-f2-gap"), r"$\Delta$ $f_1$")
    # f1 = D F_zr/F_z with the load of z = 60 (eta - 1); linear between rows
    rear = (1.1556 - 60.0 * x / 100.0 * 0.615) / 2.805
    assert y == pytest.approx((28.0 - C) * x / 100.0 * rear, abs=2e-5)

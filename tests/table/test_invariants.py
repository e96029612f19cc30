import re
from dataclasses import replace

import numpy as np
import pytest

from calib.table.invariants import violations


def changed(curve, column, row, value):
    """``curve`` with one cell set."""
    cells = np.array(getattr(curve, column))
    cells[row] = value
    return replace(curve, **{column: cells})


def test_a_sound_table_violates_nothing(table):
    assert violations(table) == ()


@pytest.mark.parametrize(
    ("part", "column", "row", "value", "says"),
    [
        ("difference", "D", 3, np.nan, "difference.D: not finite in row 3"),
        ("paper", "f2_upper", 5, np.inf, "paper.f2_upper: not finite in row 5"),
        ("difference", "eta", 4, 1.0, "difference.eta: does not increase"),
        ("paper", "eta", 4, 1.1, "paper.eta: does not increase"),
        ("tyre", "slip", 0, 0.9, "tyre.slip: does not increase"),
        ("difference", "lower", 7, 1.0, "difference.D: outside its own"),
        ("paper", "f2_upper", 7, -1.0, "paper.f2: outside its own"),
        ("paper", "z", 9, 0.9, r"paper: \(18\) is off by .* in row 9"),
        ("map", "shift", 3, 0.003, "map: its rows are not every combination of z, shift, slip"),
        ("map", "ratio_lower", 7, 3.0, "map.ratio: outside its own"),
        ("map", "change", 7, 3.0, "map.change: outside its own"),
    ],
)
def test_a_wrong_cell_is_named(table, part, column, row, value, says):
    wrong = replace(table, **{part: changed(getattr(table, part), column, row, value)})
    flaws = " | ".join(violations(wrong))
    assert re.search(says, flaws), flaws


def test_equation_18_holds_to_a_billionth(table):
    f1 = table.paper.f1[9]
    nearly = replace(table, paper=changed(table.paper, "f1", 9, f1 + 0.9e-9))
    assert violations(nearly) == ()
    off = replace(table, paper=changed(table.paper, "f1", 9, f1 + 1.1e-9))
    assert len(violations(off)) == 1
    assert "(18)" in violations(off)[0]


def test_D_is_zero_at_eta_1(table):
    D = table.difference
    moved = replace(table, difference=replace(D, D=D.D + 1e-6, upper=D.upper + 1e-6))
    assert any("where it must be 0" in flaw for flaw in violations(moved))
    cut = replace(table, difference=replace(D, eta=D.eta + 1e-4))
    apart = "paper.eta: not that of difference"
    assert violations(cut) == (apart, "difference.eta: does not reach 1")


def test_columns_of_one_curve_have_one_length(table):
    short = replace(table.tyre, slip=table.tyre.slip[:-1])
    assert "different shapes" in violations(replace(table, tyre=short))[0]


def test_a_figure_that_is_not_finite_is_named(table):
    wrong = replace(table, quality={"rms": float("nan")})
    assert violations(wrong) == ("quality: holds a number that is not finite",)

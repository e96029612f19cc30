"""`brake-cal tables diff`."""

import pytest

from tests.support.tables import C


def test_diff_gives_the_gap_of_the_curves(tables, two, document):
    difference = document(tables("diff", "sedan@1", "sedan", "--json"))
    D = next(gap for gap in difference["curves"] if gap["curve"] == "D")
    assert D["largest"] == pytest.approx((28.0 - C) * 0.005)
    assert (difference["a"], difference["b"], difference["identical"]) == (
        "sedan@1",
        "sedan@2",
        False,
    )
    ran = tables("diff", "sedan@1", "sedan")
    assert ran.code == 0
    assert "+0.00500" in ran.out


def test_diff_names_changed_keys(tables, two):
    ran = tables("diff", "sedan@1", "wagon")
    assert '"sedan"' in ran.out
    assert '"wagon"' in ran.out


def test_diff_of_the_same_says_so(tables, two):
    assert tables("diff", "sedan@1", "sedan@1").out == (
        "sedan@1 (released) and sedan@1 (released) are equal\n"
    )

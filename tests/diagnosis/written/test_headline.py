"""The outcome follows the hold-outs, whatever the verdict says."""

from dataclasses import replace

import pytest

from calib.diagnosis.written.headline import KINDS, outcome
from tests.support.written_diagnosis import LEFT, named_drag, unknown


@pytest.fixture(scope="module")
def named():
    return named_drag()


def worse(found):
    return replace(found, gap=replace(found.gap, after=found.gap.before, closed=0.0))


@pytest.mark.parametrize(
    ("change", "expected"),
    [
        (lambda found: found, "named"),
        (lambda found: replace(found, left=LEFT), "rest"),
        (lambda found: replace(found, unexplained=unknown(found).unexplained), "rest"),
        (worse, "worse"),
        (lambda found: worse(replace(found, verdict="ambiguous")), "worse"),
        (lambda found: replace(found, verdict="ambiguous"), "ambiguous"),
        (lambda found: replace(found, verdict="ambiguous", left=LEFT), "ambiguous_rest"),
        (unknown, "unknown"),
        (lambda found: replace(found, verdict="no_gap", effects=()), "no_gap"),
    ],
)
def test_a_name_is_good_only_if_the_hold_outs_say_so(named, change, expected):
    assert outcome(change(named)) == expected
    assert expected in KINDS

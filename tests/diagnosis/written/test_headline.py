"""The outcome follows the hold-outs, whatever the verdict says."""

from dataclasses import replace

import pytest

from calib.diagnosis.written.headline import KINDS, closure, headline, outcome
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


def test_the_headline_is_the_verdict_with_share_and_rest(named):
    assert headline(named) == (
        "Missing from the model: aerodynamic drag. 87.5 % of the gap on the hold-outs is closed; "
        "1.5 times the sensors' noise is left."
    )


def test_what_was_added_for_an_unknown_cause_is_told(named):
    assert closure(unknown(named)).startswith("An empirical term closes 87.5 %")
    bare = replace(unknown(named), model_after=named.model_before)
    assert closure(bare) == (
        "Nothing was added: replays of the hold-outs stay 8.2 times the sensors' noise off."
    )


def test_replays_within_the_noise_do_not_speak_against_a_name(named):
    within = replace(named, gap=replace(named.gap, before=0.25, after=0.375, closed=-0.5))
    assert closure(within) == (
        "Replays of the hold-outs do not show it: 0.2 times the sensors' noise off without it, "
        "0.4 with it."
    )


def test_a_gap_that_does_not_shrink_is_told_with_both_sizes(named):
    assert closure(worse(named)) == (
        "The gap on the hold-outs does not shrink: 8.2 times the sensors' noise before, 8.2 after."
    )


def test_an_unknown_cause_within_the_noise_points_at_the_sensors(named):
    bare = replace(unknown(named), model_after=named.model_before)
    within = replace(bare, gap=replace(named.gap, before=0.5, after=0.5, closed=0.0))
    assert "Look at the sensors first" in headline(within)
    assert "sensors first" not in headline(bare)

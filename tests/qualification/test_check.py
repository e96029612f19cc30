import math

import pytest

from calib.qualification.check import Check, Outcome, run


def check(measure=lambda material: 0.0):
    return Check("pads", "pad friction", "1", 0.4, 0.01, "a plant", measure)


@pytest.mark.parametrize(
    ("value", "held", "rounded"),
    [(0.4, True, 0), (0.4099, True, 1), (0.3901, True, -1), (0.4101, False, 1), (0.45, False, 5)],
)
def test_a_check_holds_within_its_tolerance(value, held, rounded):
    outcome = Outcome(check(), value)
    assert (outcome.held, outcome.rounded) == (held, rounded)


@pytest.mark.parametrize("value", [math.nan, math.inf, None])
def test_what_is_no_number_does_not_hold(value):
    outcome = Outcome(check(), value)
    assert not outcome.held
    assert outcome.rounded is None


def test_an_error_fails_its_own_check_and_no_other_one():
    def broken(material):
        raise ZeroDivisionError("by nought")

    one, other = run((check(broken), check(lambda material: 0.4)), None)
    assert (one.held, one.value, one.error) == (False, None, "ZeroDivisionError: by nought")
    assert other.held

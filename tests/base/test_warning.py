"""The one shape of a warning."""

import json
import math

import pytest

from calib.base.errors import NotFiniteError
from calib.base.warning import UNITS, PlausibilityWarning, to_dict


def warning_of(code="pressure_zero", expected=(-0.5, 0.5)):
    return PlausibilityWarning(code, "ramp", -2.0, expected, ("the zero of p_mc",), "zero it")


@pytest.mark.parametrize(
    ("expected", "words", "ends"),
    [
        ((0.0, 1.0), "0 to 1 bar", [0.0, 1.0]),
        ((0.0, None), "at least 0 bar", [0.0, None]),
        ((None, 1.0), "at most 1 bar", [None, 1.0]),
        ((0.0, 0.0), "0 bar", [0.0, 0.0]),
    ],
)
def test_a_bound_that_is_not_there_is_null(expected, words, ends):
    warning = warning_of(expected=expected)
    assert warning.bounds == words
    document = json.loads(json.dumps(to_dict(warning), allow_nan=False))
    assert document["expected"] == ends
    assert set(document) == {"code", "log", "measured", "expected", "causes", "do"}


@pytest.mark.parametrize("code", [*UNITS, "valid_share"])
def test_every_code_has_a_title(code):
    """A title comes from the rule of the code, or else from its metric."""
    title = warning_of(code).title
    assert title
    assert title != code or "_" not in code


@pytest.mark.parametrize("wrong", [math.nan, math.inf, -math.inf])
def test_a_number_that_is_not_finite_is_an_error_with_its_name(wrong):
    for numbers in ((wrong, (0.0, 1.0)), (0.0, (0.0, wrong))):
        with pytest.raises(NotFiniteError, match=r"^ramp: pad_ratio ") as refused:
            PlausibilityWarning("pad_ratio", "ramp", *numbers, (), "")
        assert refused.value.exit_code == 3

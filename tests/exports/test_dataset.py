"""Labels that are valid in every format."""

import re

import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.exports.dataset import LONGEST, LONGEST_PREFIX, label, prefix, printable

# C99, 6.4.2.1, without the names that C and C++ keep for themselves.
IDENTIFIER = re.compile(r"[A-Za-z](_?[A-Za-z0-9])*")


@given(st.text())
def test_any_name_gives_an_identifier(name):
    word = prefix(name)
    assert IDENTIFIER.fullmatch(word)
    assert len(word) <= LONGEST_PREFIX


@given(st.text(min_size=1), st.from_regex(r"[a-z](_?[a-z0-9]){0,60}", fullmatch=True))
def test_labels_are_identifiers_of_at_most_31_characters(name, part):
    word = label(prefix(name), part)
    assert IDENTIFIER.fullmatch(word)
    assert len(word) <= LONGEST


@pytest.mark.parametrize("pair", [("Müller", "Muller"), ("車", "车"), ("x" * 40, "x" * 41)])
def test_what_is_lost_shows_in_the_label(pair):
    assert prefix(pair[0]) != prefix(pair[1])


def test_long_labels_that_begin_alike_stay_apart():
    first, second = (label("sedan", "pad_pressure_dependence", p) for p in ("exponent", "excess"))
    assert first != second


@given(st.text())
def test_text_stays_on_one_line(text):
    assert len(printable(text).splitlines()) <= 1

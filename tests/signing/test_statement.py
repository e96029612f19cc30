"""The line of a table's signature: one spelling for each statement, and no other line."""

import re

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from calib.errors import SignatureRefused
from calib.signing.sign import sign
from calib.signing.signature import parse_signature
from calib.signing.statement import STATES, Statement, parse_statement
from calib.store.folders import NAME

HEX = st.from_regex(re.compile("[0-9a-f]{64}"), fullmatch=True)
STATEMENTS = st.builds(
    Statement,
    st.from_regex(NAME, fullmatch=True),  # every name that the store allows
    st.integers(1, 999_999),
    st.sampled_from(STATES),
    HEX,
    HEX,
)
SEDAN = Statement("sedan-2up", 3, "released", "0123456789abcdef" * 4, "f" * 64)
LINE = (
    "brake-cal table=sedan-2up version=3 state=released"
    f" digest={'0123456789abcdef' * 4} journal={'f' * 64}"
)


def test_the_line_is_as_written_down():
    assert SEDAN.line == LINE
    assert parse_statement(LINE) == SEDAN


@given(STATEMENTS)
def test_a_statement_comes_back_from_its_line(statement):
    assert parse_statement(statement.line) == statement


@given(STATEMENTS)
def test_a_statement_comes_back_from_a_signature_file(key, statement):
    content = sign(key, b"data", statement.line)
    assert parse_statement(parse_signature(content).trusted_comment) == statement


@given(STATEMENTS, STATEMENTS)
def test_two_statements_have_two_lines(one, other):
    assert (one == other) == (one.line == other.line)


def accepted(line: str) -> bool:
    """Whether a line is read; if it is, it is the spelling of what was read."""
    try:
        statement = parse_statement(line)
    except SignatureRefused:
        return False
    assert statement.line == line
    return True


@given(st.text())
@example("brake-cal")
def test_other_text_is_refused(text):
    assert not accepted(text)


SIGNS = st.characters() | st.sampled_from(" =\n\r\t0123456789abcdefABCDEF٣")


@given(st.integers(0, len(LINE)), st.integers(0, 3), st.text(SIGNS, max_size=3))
def test_a_changed_line_is_refused_or_says_exactly_what_it_says(place, cut, put):
    line = LINE[:place] + put + LINE[place + cut :]
    assert accepted(line) in ((True,) if line == LINE else (True, False))


@pytest.mark.parametrize(
    ("old", "new"),
    [
        ("version=3", "version=03"),
        ("version=3", "version=0"),
        ("version=3", "version=-3"),
        ("version=3", "version=+3"),
        ("version=3", "version=3.0"),
        ("version=3", "version=٣"),
        ("version=3", "version=1000000"),
        ("version=3", "version="),
        ("version=3 state=released", "state=released version=3"),
        ("version=3", "version=3 version=3"),
        ("state=released", "state=golden"),
        ("state=released", "state=Released"),
        ("table=sedan-2up", "table="),
        ("table=sedan-2up", "table=sedan 2up"),
        ("table=sedan-2up", "table=../sedan"),
        ("table=sedan-2up", "table=sédan"),
        ("digest=0123", "digest=012"),
        ("digest=0123456789a", "digest=0123456789A"),
        (" table", "  table"),
        (" table", "\u00a0table"),
        (" table", "\ttable"),
        ("brake-cal", "Brake-cal"),
        ("brake-cal", " brake-cal"),
        ("journal=f", "journal=g"),
        ("journal=f", "head=f"),
    ],
)
def test_a_near_miss_is_refused(old, new):
    assert old in LINE
    assert not accepted(LINE.replace(old, new, 1))


@pytest.mark.parametrize("end", [" ", "\n", "\r", "\0", " extra=1"])
def test_nothing_may_follow(end):
    assert not accepted(LINE + end)


def test_the_refusal_names_the_file_and_ends_with_4():
    with pytest.raises(SignatureRefused, match=r"car\.minisig: its trusted comment") as refusal:
        parse_statement("timestamp:1\tfile:a", "car.minisig")
    assert refusal.value.exit_code == 4


@pytest.mark.parametrize(
    "values",
    [
        ("sedan 2up", 3, "released", "0" * 64, "f" * 64),
        ("sedan", 0, "released", "0" * 64, "f" * 64),
        ("sedan", 1_000_000, "released", "0" * 64, "f" * 64),
        ("sedan", 3, "golden", "0" * 64, "f" * 64),
        ("sedan", 3, "released", "0" * 63, "f" * 64),
        ("sedan", 3, "released", "0" * 64, "F" * 64),
        ("sedan", 3, "released", "0" * 64, "f" * 64 + "\n"),
    ],
)
def test_a_statement_that_has_no_line_cannot_be_made(values):
    with pytest.raises(ValueError, match="has no place in a signature"):
        Statement(*values)

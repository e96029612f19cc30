"""Signatures, files of Debian's minisign: what is read, signed, verified, and what is refused."""

import re
from base64 import b64decode
from dataclasses import replace

import pytest
from hypothesis import example, given
from hypothesis import strategies as st

from calib.base.errors import SignatureRefused
from calib.store.folders import NAME
from calib.store.minisign import (
    LEGACY,
    PREHASHED,
    STATES,
    Statement,
    parse_signature,
    parse_statement,
    sign,
    verify,
)
from calib.store.minisign_keys import PublicKey, SecretKey, read_public_key
from tests.store.golden.make import COMMENT, DATA, HERE

ALPHABET = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"
NAMES = ("open", "small", "sensitive", "legacy")


@pytest.mark.parametrize("name", NAMES)
def test_what_is_read_is_what_is_written(golden, name):
    content = (golden / f"{name}.minisig").read_bytes()
    signature = parse_signature(content)
    assert signature.file == content
    assert signature.algorithm == (LEGACY if name == "legacy" else PREHASHED)
    key = "open" if name == "legacy" else name
    assert signature.key_id == (golden / f"{key}.pub").read_text().split("\n")[0].split()[-1]


def test_line_ends_of_windows_are_read(content):
    assert parse_signature(content.replace(b"\n", b"\r\n")) == parse_signature(content)


@pytest.mark.parametrize("name", NAMES)
def test_a_file_cut_at_any_place_is_refused(golden, name):
    content = (golden / f"{name}.minisig").read_bytes()
    for end in range(len(content)):
        with pytest.raises(SignatureRefused, match=r"^sedan\.minisig: "):
            parse_signature(content[:end], "sedan.minisig")


@pytest.mark.parametrize(
    ("old", "new"),
    [
        *[(b"untrusted comment: ", b"comment: "), (b"\ntrusted comment: ", b"\ncomment: ")],
        *[(b"\nRU", b"\nRX"), (b"\nRU", b"\n!U"), (b"\nRU", b"\nRUAAAA")],
        *[(b"car 7", b"car" + sign + b"7") for sign in (b"\0", b"\r", b"\x1b[31m", b"\xff", b"\n")],
        *[(b"car 7", b"c" * 8200), (b"from", b"f" * 1100), (b"from", b"f" * 20000)],
        (b"\ntrusted", b" trusted"),
    ],
)
def test_what_is_malformed_is_refused(content, old, new):
    assert content.count(old) == 1
    with pytest.raises(SignatureRefused):
        parse_signature(content.replace(old, new))


def test_a_second_spelling_of_the_same_bytes_is_refused(content):
    """The last character of a signature carries bits that base64 does not use."""
    lines = content.split(b"\n")
    last = lines[1][-2:-1]
    twin = ALPHABET[ALPHABET.index(last) ^ 1 :][:1]
    assert b64decode(lines[1][:-2] + twin + b"=") == b64decode(lines[1])
    lines[1] = lines[1][:-2] + twin + b"="
    with pytest.raises(SignatureRefused, match="not base64 as minisign writes it"):
        parse_signature(b"\n".join(lines))


@given(st.binary(max_size=400) | st.text().map(lambda s: f"untrusted comment: {s}\n".encode()))
def test_other_bytes_are_refused_and_never_a_traceback(content):
    with pytest.raises(SignatureRefused):
        parse_signature(content)


# Made and verified.
PUBLIC = read_public_key(HERE / "open.pub")
CONTENT = (HERE / "open.minisig").read_bytes()
UNTRUSTED = range(len("untrusted comment: "), CONTENT.index(b"\n"))
"""Bytes of the comment that is not signed: nobody can tell whether they were changed."""


def outcome(content: bytes, data: bytes = DATA) -> str:
    return verify(PUBLIC, data, parse_signature(content))


def changed(content: bytes, place: int, by: int) -> bytes:
    return content[:place] + bytes([content[place] ^ by]) + content[place + 1 :]


@pytest.mark.parametrize("name", ["open", "small", "sensitive"])
def test_a_signature_of_minisign_holds(golden, name):
    public = read_public_key(golden / f"{name}.pub")
    signature = parse_signature((golden / f"{name}.minisig").read_bytes())
    assert verify(public, DATA, signature) == COMMENT


def test_a_signature_of_the_older_kind_holds(golden):
    comment = outcome((golden / "legacy.minisig").read_bytes())
    assert comment.startswith("timestamp:")


def test_the_same_key_makes_the_bytes_that_minisign_made(key):
    """Ed25519 has one signature for each key and message (RFC 8032)."""
    assert sign(key, DATA, COMMENT, "signature from minisign secret key") == CONTENT


@pytest.mark.parametrize("by", [1 << bit for bit in range(8)])
def test_every_flipped_bit_of_the_file_is_refused(by):
    for place in sorted(set(range(len(CONTENT))) - set(UNTRUSTED)):
        with pytest.raises(SignatureRefused):
            outcome(changed(CONTENT, place, by))


@given(st.integers(0, len(CONTENT) - 1), st.integers(1, 255))
def test_every_changed_byte_of_the_file_is_refused(place, by):
    content = changed(CONTENT, place, by)
    if place in UNTRUSTED:  # refused, or believed for what is signed
        try:
            assert outcome(content) == COMMENT
        except SignatureRefused:
            return
    else:
        with pytest.raises(SignatureRefused):
            outcome(content)


def test_every_flipped_bit_of_the_data_is_refused(golden):
    legacy = (golden / "legacy.minisig").read_bytes()
    for place in range(len(DATA)):
        for bit in range(8):
            for content in (CONTENT, legacy):
                with pytest.raises(SignatureRefused):
                    outcome(content, changed(DATA, place, 1 << bit))


@pytest.mark.parametrize("data", [b"", DATA[:-1], DATA + b"\n", DATA[1:], DATA * 2])
def test_cut_and_extended_data_is_refused(data):
    with pytest.raises(SignatureRefused, match="the data is not what was signed"):
        outcome(CONTENT, data)


def test_a_signature_of_another_key_is_refused_with_both_names(golden):
    other = read_public_key(golden / "small.pub")
    with pytest.raises(SignatureRefused) as refusal:
        verify(other, DATA, parse_signature(CONTENT), "a.minisig")
    said = f"a.minisig: is of key {PUBLIC.key_id}; expected key {other.key_id}"
    assert str(refusal.value) == said


def test_another_key_under_the_same_number_is_refused(golden):
    other = read_public_key(golden / "small.pub")
    with pytest.raises(SignatureRefused, match="does not hold"):
        verify(PublicKey(PUBLIC.number, other.point), DATA, parse_signature(CONTENT))


def test_the_trusted_comment_of_another_signature_is_refused(key):
    ours = parse_signature(CONTENT)
    other = parse_signature(sign(key, DATA + b"2", "car 8, released"))
    mixed = replace(ours, trusted_comment=other.trusted_comment, of_comment=other.of_comment)
    with pytest.raises(SignatureRefused, match="its trusted comment is not what was signed"):
        verify(PUBLIC, DATA, mixed)


@pytest.mark.parametrize(("name", "other"), [("open", LEGACY), ("legacy", PREHASHED)])
def test_the_other_algorithm_is_refused(golden, name, other):
    signature = parse_signature((golden / f"{name}.minisig").read_bytes())
    with pytest.raises(SignatureRefused, match="the data is not what was signed"):
        verify(PUBLIC, DATA, replace(signature, algorithm=other))


@given(st.binary(max_size=300), st.text(max_size=50), st.binary(min_size=32, max_size=32))
def test_what_is_signed_holds_with_any_key_data_and_comment(data, comment, seed):
    key = SecretKey(b"car 0007", seed)
    try:
        content = sign(key, data, comment)
    except ValueError:
        assert not comment.isprintable()
        return
    assert verify(key.public, data, parse_signature(content)) == comment


@pytest.mark.parametrize("comment", ["a\nb", "a\r", "\0", "\x1b[0m", "\x85", "é" * 4087])
def test_a_comment_that_is_not_one_line_is_not_signed(key, comment):
    with pytest.raises(ValueError, match="the trusted comment"):
        sign(key, DATA, comment)
    with pytest.raises(ValueError, match="the untrusted comment"):
        sign(key, DATA, "", comment)


def test_the_longest_comment_holds(key):
    content = sign(key, DATA, "é" * 4086 + "e", "é" * 501 + "e")
    assert outcome(content) == "é" * 4086 + "e"


# What the signature of a table says.
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
        *[("f" * 64, "f" * 64 + end) for end in (" ", "\n", "\r", "\0", " extra=1")],
    ],
)
def test_a_near_miss_is_refused(old, new):
    assert old in LINE
    assert not accepted(LINE.replace(old, new, 1))


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

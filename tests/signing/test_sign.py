"""Signing and verifying: files of Debian's minisign, and every change to them."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.errors import SignatureRefused
from calib.signing.public_key import PublicKey, read_public_key
from calib.signing.secret_key import SecretKey
from calib.signing.sign import sign, verify
from calib.signing.signature import LEGACY, PREHASHED, parse_signature
from tests.signing.golden.make import COMMENT, DATA, HERE

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


@given(st.integers(0, len(DATA) - 1), st.integers(1, 255))
def test_every_changed_byte_of_the_data_is_refused(place, by):
    with pytest.raises(SignatureRefused, match="the data is not what was signed"):
        outcome(CONTENT, changed(DATA, place, by))


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

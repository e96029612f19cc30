"""Signature files, as bytes: what is read and what is refused. The files are Debian's."""

from base64 import b64decode

import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.errors import SignatureRefused
from calib.signing.signature import LEGACY, PREHASHED, parse_signature
from tests.signing.golden.make import COMMENT

ALPHABET = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/"
NAMES = ("open", "small", "sensitive", "legacy")


@pytest.mark.parametrize("name", NAMES)
def test_what_is_read_is_what_is_written(golden, name):
    content = (golden / f"{name}.minisig").read_bytes()
    assert parse_signature(content).file == content


@pytest.mark.parametrize("name", NAMES)
def test_the_key_is_named_as_minisign_names_it(golden, name):
    key = "open" if name == "legacy" else name
    named = (golden / f"{key}.pub").read_text().split("\n")[0].split()[-1]
    assert parse_signature((golden / f"{name}.minisig").read_bytes()).key_id == named


def test_the_parts_of_a_file(content):
    signature = parse_signature(content)
    assert signature.algorithm == PREHASHED
    assert signature.trusted_comment == COMMENT
    assert signature.untrusted_comment == "signature from minisign secret key"
    assert (len(signature.number), len(signature.of_data), len(signature.of_comment)) == (8, 64, 64)


def test_the_older_algorithm_and_a_comment_with_a_tab(golden):
    signature = parse_signature((golden / "legacy.minisig").read_bytes())
    assert signature.algorithm == LEGACY
    assert signature.trusted_comment.endswith("\tfile:data.bin")


def test_line_ends_of_windows_are_read(content):
    assert parse_signature(content.replace(b"\n", b"\r\n")) == parse_signature(content)


@pytest.mark.parametrize("name", NAMES)
def test_a_file_cut_at_any_place_is_refused(golden, name):
    content = (golden / f"{name}.minisig").read_bytes()
    for end in range(len(content)):
        with pytest.raises(SignatureRefused, match=r"^sedan\.minisig: "):
            parse_signature(content[:end], "sedan.minisig")


@pytest.mark.parametrize(
    ("old", "new", "says"),
    [
        (b"untrusted comment: ", b"comment: ", "no untrusted comment where it belongs"),
        (b"\ntrusted comment: ", b"\ncomment: ", "no trusted comment where it belongs"),
        (b"\nRU", b"\nRX", "unknown algorithm"),
        (b"\nRU", b"\n!U", "the signature is not base64"),
        (b"\nRU", b"\nRUAAAA", "the signature has 77 bytes, not 74"),
        (b"car 7", b"car\x007", "the trusted comment has a control character"),
        (b"car 7", b"car\r7", "the trusted comment has a control character"),
        (b"car 7", b"car\x1b[31m7", "the trusted comment has a control character"),
        (b"car 7", b"car\xff7", "the trusted comment is not UTF-8"),
        (b"car 7", b"c" * 8200, "the trusted comment is longer than 8173 bytes"),
        (b"from", b"f" * 1100, "the untrusted comment is longer than 1003 bytes"),
        (b"from", b"f" * 20000, "is longer than 16384 bytes"),
        (b"car 7", b"car\n7", "has 5 lines"),
        (b"\ntrusted", b" trusted", "has 3 lines"),
    ],
)
def test_what_is_malformed_is_refused_by_name(content, old, new, says):
    assert content.count(old) == 1
    with pytest.raises(SignatureRefused, match=says):
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

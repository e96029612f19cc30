"""Keys and signatures of Debian's minisign: what is read, made, and refused."""

import os
import stat
import sys
import traceback
from base64 import b64decode, b64encode

import pytest

import calib.store.minisign
from calib.base.errors import KeyFileError, SignatureRefused
from calib.store.minisign import generate, read_public_key, read_secret_key, read_signature, verify
from tests.store.golden.make import COMMENT, DATA, HERE, PASSWORD

CHEAP = {"opslimit": 2**15, "memlimit": 2**24}
OPEN = HERE / "open.key"
PUBLIC = read_public_key(HERE / "open.pub")
CONTENT = (HERE / "open.minisig").read_bytes()
UNTRUSTED = range(len("untrusted comment: "), CONTENT.index(b"\n"))
"""Bytes of the comment that is not signed: nobody can tell whether they were changed."""


@pytest.fixture
def files(tmp_path, monkeypatch):
    """Names for a new pair, whose password takes little time."""
    monkeypatch.setattr(calib.store.minisign, "_SCRYPT", CHEAP)
    return tmp_path / "car.key", tmp_path / "car.pub"


@pytest.fixture
def comment_of(tmp_path):
    """Verify the content of a signature file, and return its trusted comment."""

    def verified(content, data=DATA, public=PUBLIC):
        path = tmp_path / "a.minisig"
        path.write_bytes(content)
        signature = read_signature(path)
        verify(public, data, signature, path)
        return signature.trusted_comment

    return verified


def never():
    raise AssertionError("no password is needed")


# Made by minisign


@pytest.mark.parametrize("name", ["open", "small"])
def test_keys_and_signatures_of_minisign(comment_of, name):
    public = read_public_key(HERE / f"{name}.pub")
    key = read_secret_key(HERE / f"{name}.key", never if name == "open" else lambda: PASSWORD)
    assert key.public == public == read_public_key(public.text)
    assert public.file == (HERE / f"{name}.pub").read_bytes()
    assert comment_of((HERE / f"{name}.minisig").read_bytes(), public=public) == COMMENT
    assert comment_of(key.sign(DATA, "line 7"), public=public) == "line 7"


# Refused


def test_every_changed_byte_of_a_signature_is_refused(comment_of):
    for place in sorted({*range(len(CONTENT))} - {*UNTRUSTED}):
        content = bytearray(CONTENT)
        content[place] ^= 1
        try:
            # the last character of base64 has bits that are not used
            assert comment_of(bytes(content)) == COMMENT
            assert CONTENT[place + 1 : place + 2] == b"="
        except SignatureRefused:
            continue


@pytest.mark.parametrize("name", ["open.minisig", "open.pub", "open.key"])
def test_a_file_that_is_cut_off_is_refused(comment_of, tmp_path, name):
    content = (HERE / name).read_bytes()
    path = tmp_path / name
    read = {
        ".minisig": lambda: comment_of(path.read_bytes()),
        ".pub": lambda: read_public_key(path),
        ".key": lambda: read_secret_key(path, never),
    }[path.suffix]
    for end in range(len(content) - 1):
        path.write_bytes(content[:end])
        with pytest.raises((KeyFileError, SignatureRefused)):
            read()


@pytest.mark.parametrize("source", ["no/such.pub", "RWtooShort", "\0", ".", "/dev/zero"])
def test_what_is_no_public_key_is_refused(source):
    with pytest.raises(KeyFileError) as refusal:
        read_public_key(source)
    assert refusal.value.exit_code == 3


def put(content, place, part):
    return content[:place] + part + content[place + len(part) :]


SMALL = b64decode((HERE / "small.key").read_text().split("\n")[1])
SEED = b64decode(OPEN.read_text().split("\n")[1])


def test_no_refusal_shows_the_key_or_the_password(tmp_path):
    """Wrong passwords, damage, and files that ask for a gigabyte too much or for ever."""
    path = tmp_path / "car.key"
    wrong = "Rote Bremse \udcff"
    for content, password in (
        *((SMALL, word) for word in ("", PASSWORD + " ", wrong)),
        *((put(SMALL, place, b"xx"), PASSWORD) for place in (0, 2, 4, 6, 54, 62, 94, 156)),
        (put(SMALL, 38, b"\xff" * 8), PASSWORD),
        (put(SMALL, 46, b"\xff" * 8), PASSWORD),
        *((SEED[:-1], PASSWORD), (SEED + b"\0", PASSWORD), (b"", PASSWORD)),
    ):
        path.write_bytes(b"untrusted comment: a\n" + b64encode(content) + b"\n")
        with pytest.raises(KeyFileError) as refusal:
            read_secret_key(path, lambda typed=password: typed)
        text = "".join(traceback.format_exception(refusal.value)) + repr(vars(refusal.value))
        assert not any(x in text for x in (PASSWORD, "Rote", repr(SMALL[-104:])[2:-1]))
        assert b64encode(SMALL[-104:]).decode()[4:-4] not in text


# New pairs


@pytest.mark.parametrize("password", ["", "Brems\u00e9"])
def test_a_new_pair_signs_and_only_its_owner_reads_the_secret_key(files, comment_of, password):
    old = os.umask(0)
    try:
        public = generate(*files, password)
    finally:
        os.umask(old)
    assert [stat.S_IMODE(path.stat().st_mode) for path in files] == [0o600, 0o644]
    key = read_secret_key(files[0], (lambda: password) if password else never)
    assert public == key.public == read_public_key(files[1])
    assert comment_of(key.sign(b"data", "comment"), b"data", public) == "comment"


@pytest.mark.parametrize("existing", [0, 1])
def test_an_existing_file_is_not_replaced(files, existing):
    files[existing].write_text("precious")
    with pytest.raises(KeyFileError) as refusal:
        generate(*files, "")
    assert refusal.value.where == files[existing]
    assert [path.read_text() for path in files if path.exists()] == ["precious"]


def test_without_the_extra_it_is_named_and_key_numbers_are_read(monkeypatch, files):
    monkeypatch.setitem(sys.modules, "minisign", None)
    assert read_signature(HERE / "open.minisig").key_id == PUBLIC.key_id
    uses = (
        lambda: read_public_key(HERE / "open.pub"),
        lambda: read_secret_key(OPEN, never),
        lambda: generate(*files, ""),
        lambda: verify(PUBLIC, DATA, read_signature(HERE / "open.minisig"), "a"),
    )
    for use in uses:
        with pytest.raises(KeyFileError) as refusal:
            use()
        assert "brake-cal[sign]" in refusal.value.do

"""Secret keys: those of Debian's minisign, hostile ones, and that nothing secret is shown."""

import copy
import pickle
import subprocess
import sys
import traceback
from base64 import b64decode, b64encode
from hashlib import blake2b
from pathlib import Path

import pytest

from calib.errors import KeyFileError
from calib.signing.password import Cost, mask
from calib.signing.public_key import read_public_key
from calib.signing.secret_key import SecretKey, read_secret_key
from tests.signing.conftest import never
from tests.signing.golden.make import HERE, PASSWORD

ROOT = Path(__file__).parents[2]
OPEN = b64decode((HERE / "open.key").read_text().split("\n")[1])
SMALL = b64decode((HERE / "small.key").read_text().split("\n")[1])
SEED = OPEN[62:94]


@pytest.fixture
def write(tmp_path):
    """Write the 158 bytes as a key file."""

    def write(content: bytes):
        path = tmp_path / "car.key"
        path.write_bytes(b"untrusted comment: a key\n" + b64encode(content) + b"\n")
        return path

    return write


def put(content: bytes, place: int, part: bytes) -> bytes:
    return content[:place] + part + content[place + len(part) :]


def refusal_of(path, password=lambda: PASSWORD) -> KeyFileError:
    with pytest.raises(KeyFileError, match=r"car\.key: ") as refusal:
        read_secret_key(path, password)
    assert refusal.value.exit_code == 3
    return refusal.value


@pytest.mark.parametrize("name", ["open", "small", "sensitive"])
def test_a_key_of_minisign_has_the_public_half_that_minisign_wrote(golden, name):
    key = read_secret_key(golden / f"{name}.key", never if name == "open" else lambda: PASSWORD)
    assert key.public == read_public_key(golden / f"{name}.pub")


def test_line_ends_of_windows_are_read(golden, tmp_path):
    path = tmp_path / "car.key"
    path.write_bytes((golden / "open.key").read_bytes().replace(b"\n", b"\r\n"))
    assert read_secret_key(path, never).public == read_public_key(golden / "open.pub")


@pytest.mark.parametrize("password", ["", "grüne Bremse 7", PASSWORD + " ", "\udcff"])
def test_a_wrong_password_is_refused(golden, password):
    with pytest.raises(KeyFileError, match="the password is wrong, or the file is damaged"):
        read_secret_key(golden / "small.key", lambda: password)


def test_every_flipped_byte_of_an_open_key_is_refused(write):
    unused = range(6, 54)  # salt, work and memory of a key without a password
    for place in sorted(set(range(len(OPEN))) - set(unused)):
        if 54 <= place < 62:  # the number: minisign 0.11 writes no checksum there
            continue
        refusal_of(write(put(OPEN, place, bytes([OPEN[place] ^ 1]))))


def test_the_checksum_of_an_open_key_is_checked_where_there_is_one(write):
    """`minisign -C -W` leaves one."""
    checksum = blake2b(OPEN[:2] + OPEN[54:126], digest_size=32).digest()
    whole = put(OPEN, 126, checksum)
    assert read_secret_key(write(whole), never).public.number == OPEN[54:62]
    for place in range(54, 158):
        error = refusal_of(write(put(whole, place, bytes([whole[place] ^ 128]))), never)
        assert "is damaged: the checksum does not match" in str(error)


def test_every_part_of_a_locked_key_is_checked(write):
    for place in (0, 1, 2, 3, 4, 5, 6, 37, 54, 62, 94, 126, 157):
        refusal_of(write(put(SMALL, place, bytes([SMALL[place] ^ 1]))))


def test_a_locked_key_without_a_checksum_is_refused(write):
    """Only a key without a password may lack one."""
    cost = Cost(*(int.from_bytes(SMALL[i : i + 8], "little") for i in (38, 46)))
    stream = mask(PASSWORD, SMALL[6:38], cost, 104, KeyFileError)
    error = refusal_of(write(put(SMALL, 126, stream[72:])))
    assert "the checksum does not match" in str(error)


@pytest.mark.parametrize("name", ["open", "small"])
def test_a_file_cut_at_any_place_is_refused(golden, tmp_path, name):
    content = (golden / f"{name}.key").read_bytes()
    path = tmp_path / "car.key"
    for end in range(len(content)):
        path.write_bytes(content[:end])
        refusal_of(path, never)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (OPEN[:-1], "has 157 bytes, not 158"),
        (OPEN + b"\0", "has 159 bytes, not 158"),
        (b"", "has 0 bytes, not 158"),
        (put(OPEN, 0, b"ED"), "unknown algorithm"),
        (put(OPEN, 4, b"B3"), "unknown algorithm"),
        (put(OPEN, 2, b"Ar"), "unknown protection"),
        (put(OPEN, 94, bytes(32)), "the secret and the public half are not of one key"),
        (put(SMALL, 46, (2**31 + 1).to_bytes(8, "little")), "asks for 2 GiB of memory"),
        (put(SMALL, 46, b"\xff" * 8), "asks for 1.718e.10 GiB of memory; expected at most 2 GiB"),
        (put(SMALL, 38, b"\xff" * 8), "times the work of a key of minisign; expected at most 8"),
    ],
)
def test_a_hostile_file_is_refused_before_a_password_is_asked_for(write, content, says):
    with pytest.raises(KeyFileError, match=says):
        read_secret_key(write(content), never)


def test_base64_of_another_kind_is_refused(golden, tmp_path):
    text = (golden / "open.key").read_text()
    path = tmp_path / "car.key"
    for old, new in (("RW", "-W"), ("RW", " RW"), ("RW", "R\u00dc"), ("\nRW", "\n\nRW")):
        path.write_text(text.replace(old, new, 1))
        refusal_of(path, never)


def test_want_of_memory_is_said(golden):
    """The key asks for 1 GiB where there are 400 MB."""
    code = (
        "import resource, sys; from pathlib import Path; from calib.errors import KeyFileError\n"
        "from calib.signing.secret_key import read_secret_key\n"
        "resource.setrlimit(resource.RLIMIT_AS, (400_000_000, 400_000_000))\n"
        "try: read_secret_key(Path(sys.argv[1]), lambda: 'a')\n"
        "except KeyFileError as error: print(error)"
    )
    path = golden / "sensitive.key"
    run = subprocess.run(
        [sys.executable, "-c", code, path], cwd=ROOT, capture_output=True, text=True, check=True
    )
    said = f"{path}: its password needs 1024 MiB of memory, which is not free\n"
    assert (run.stdout, run.stderr) == (said, "")


def spellings(secret: bytes) -> list[str]:
    """How a secret could appear in a text; base64 in each of its three alignments."""
    inner = [b64encode(b"\0" * i + secret).decode()[4:-4] for i in range(3)]
    return [secret.hex(), secret.hex().upper(), repr(secret)[2:-1], *inner]


def test_the_test_for_secrets_finds_them(golden):
    text = (golden / "open.key").read_text()
    assert any(s in text for s in spellings(SEED))
    assert any(s in f"{SecretKey!r} {SEED!r}" for s in spellings(SEED))


def test_the_text_of_a_key_shows_its_number_only(key):
    assert repr(key) == str(key) == f"{key}" == f"SecretKey({key.key_id})"
    assert not hasattr(key, "__dict__")


@pytest.mark.parametrize("way", [copy.copy, copy.deepcopy, pickle.dumps])
def test_a_key_is_not_copied_into_a_file_or_a_message(key, way):
    with pytest.raises(TypeError, match="a secret key is not copied"):
        way(key)


def test_no_refusal_shows_the_key_or_the_password(write):
    wrong = "Rote Bremse \udcff\ud800"
    hidden = SMALL[-104:]
    for content in (
        *(OPEN[:-1], put(OPEN, 0, b"ED"), put(OPEN, 2, b"Ar"), put(OPEN, 94, bytes(32))),
        *(put(OPEN, 126, b"x" * 32), put(SMALL, 157, b"x"), put(SMALL, 46, b"\xff" * 8)),
    ):
        for password in (PASSWORD, wrong):
            error = refusal_of(write(content), lambda typed=password: typed)
            whole = "".join(traceback.format_exception(error)) + repr(error) + repr(vars(error))
            assert not any(s in whole for s in spellings(SEED) + spellings(hidden))
            assert PASSWORD not in whole
            assert "Rote" not in whole

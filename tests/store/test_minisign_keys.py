"""Keys: those of Debian's minisign, hostile ones, new pairs, and that nothing secret is shown."""

import copy
import ctypes
import ctypes.util
import os
import pickle
import stat
import subprocess
import sys
import traceback
from base64 import b64decode, b64encode
from hashlib import blake2b
from pathlib import Path

import pytest

from calib.base.errors import KeyFileError
from calib.store.minisign import PREHASHED, Signature, parse_signature, sign, verify
from calib.store.minisign_keys import (
    Cost,
    PublicKey,
    SecretKey,
    check_cost,
    generate,
    mask,
    read_public_key,
    read_secret_key,
    scrypt_numbers,
)
from tests.store.conftest import never
from tests.store.golden.make import HERE, PASSWORD

ROOT = Path(__file__).parents[2]
OPEN = b64decode((HERE / "open.key").read_text().split("\n")[1])
SMALL = b64decode((HERE / "small.key").read_text().split("\n")[1])
SEED = OPEN[62:94]
CHEAP = Cost(2**15, 2**24)


@pytest.fixture
def write(tmp_path):
    """Write the bytes of a key as a file."""

    def write(content: bytes):
        path = tmp_path / "car.key"
        path.write_bytes(b"untrusted comment: a key\n" + b64encode(content) + b"\n")
        return path

    return write


# Public keys.
PRIME = 2**255 - 19
ORDER = 2**252 + 27742317777372353535851937790883648493  # of the large subgroup
D = -121665 * pow(121666, -1, PRIME) % PRIME


def add(a, b):
    """Sum of two points of Ed25519 (RFC 8032, 5.1.4), in affine coordinates."""
    (x1, y1), (x2, y2) = a, b
    t = D * x1 * x2 * y1 * y2
    x = (x1 * y2 + x2 * y1) * pow(1 + t, -1, PRIME)
    y = (y1 * y2 + x1 * x2) * pow(1 - t, -1, PRIME)
    return x % PRIME, y % PRIME


def times(n, point):
    total = (0, 1)
    while n:
        total, point, n = (add(total, point) if n & 1 else total), add(point, point), n >> 1
    return total


def point_at(y):
    """A point with this y; None if there is none."""
    square = (y * y - 1) * pow(D * y * y + 1, -1, PRIME) % PRIME
    root = pow(square, (PRIME + 3) // 8, PRIME)
    for x in (root, root * pow(2, (PRIME - 1) // 4, PRIME) % PRIME):
        if x * x % PRIME == square:
            return x, y
    return None


def small_points():
    """The points whose order divides 8: the large order times any point."""
    found, y = set(), 2
    while len(found) < 8:
        point = point_at(y)
        y += 1
        if point:
            small = times(ORDER, point)
            found |= {times(n, small) for n in range(8)}
    return sorted(found)


def encoded(x, y):
    return (y | (x & 1) << 255).to_bytes(32, "little")


@pytest.mark.parametrize("name", ["open", "small", "sensitive"])
def test_file_and_word_are_the_same_key(golden, name):
    path = golden / f"{name}.pub"
    comment, word = path.read_text().splitlines()
    key = read_public_key(path)
    assert key == read_public_key(str(path)) == read_public_key(word)
    assert comment.endswith(f" {key.key_id}")
    assert (key.text, key.file) == (word, path.read_bytes())


def test_a_number_that_opens_with_zeros_is_printed_without_them():
    assert PublicKey(bytes([0xEF, 0xBE, 0, 0, 0, 0, 0, 0]), bytes(32)).key_id == "BEEF"


@pytest.mark.parametrize(
    "text",
    [
        *(b"RW" + b"A" * 53, b"RW" + b"A" * 53 + b"=", b"RW" + b"A" * 58, b"RW" + b"-" * 54),
        *(b" RW" + b"A" * 53, b"RW" + b"\xff" * 54, b"", b"RU" + b"A" * 54),
        b"RW" + b"A" * 54 + b"\n",
    ],
)
def test_a_hostile_public_key_is_refused(tmp_path, text):
    path = tmp_path / "car.pub"
    path.write_bytes(b"untrusted comment: a key\n" + text + b"\n")
    with pytest.raises(KeyFileError, match=r"car\.pub: "):
        read_public_key(path)


def test_a_file_without_a_comment_is_refused(golden, tmp_path):
    path = tmp_path / "car.pub"
    path.write_bytes(b"my key\n" + (golden / "open.pub").read_bytes().split(b"\n")[1] + b"\n")
    with pytest.raises(KeyFileError, match=r"car\.pub: "):
        read_public_key(path)


def test_a_secret_key_is_not_taken_for_a_public_one_and_not_shown(golden):
    with pytest.raises(KeyFileError, match="has 158 bytes, not 42") as refusal:
        read_public_key(golden / "open.key")
    assert (golden / "open.key").read_text().split("\n")[1][10:30] not in str(refusal.value)


@pytest.mark.parametrize("source", ["no/such.pub", "RWtooShort", "\0", ".", "/dev/zero"])
def test_what_cannot_be_read_is_refused(source):
    with pytest.raises(KeyFileError, match=r"cannot be read|is longer than") as refusal:
        read_public_key(source)
    assert refusal.value.exit_code == 3


def test_keys_that_everybody_can_sign_for_are_refused():
    small = small_points()
    assert len(small) == 8
    twins = [(0, PRIME), (0, PRIME + 1), (1, PRIME + 1)]  # y beyond the prime: a second spelling
    for x, y in small + twins:
        word = b64encode(b"Ed" + bytes(8) + encoded(x, y)).decode()
        with pytest.raises(KeyFileError, match="everybody can sign for it"):
            read_public_key(word)


# Files of both.
@pytest.mark.parametrize(
    ("name", "read"),
    [
        ("open.pub", read_public_key),
        ("open.key", lambda path: read_secret_key(path, never)),
        ("small.key", lambda path: read_secret_key(path, never)),
    ],
)
def test_a_file_cut_at_any_place_is_refused(golden, tmp_path, name, read):
    content = (golden / name).read_bytes()
    path = tmp_path / name
    for end in range(len(content)):
        path.write_bytes(content[:end])
        with pytest.raises(KeyFileError, match=name):
            read(path)


def test_line_ends_of_windows_are_read(golden, tmp_path):
    for name in ("open.pub", "open.key"):
        content = (golden / name).read_bytes()
        (tmp_path / name).write_bytes(content.replace(b"\n", b"\r\n"))
    public = read_public_key(tmp_path / "open.pub")
    assert public == read_public_key(golden / "open.pub")
    assert read_secret_key(tmp_path / "open.key", never).public == public


# Secret keys.
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
        "import resource, sys; from pathlib import Path\n"
        "from calib.base.errors import KeyFileError\n"
        "from calib.store.minisign_keys import read_secret_key\n"
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


# Passwords.
LIBRARY = ctypes.util.find_library("sodium")

COSTS = [
    Cost(0, 0),
    Cost(2**15, 2**24),  # work limits N
    Cost(2**20, 2**25),  # both, as minisign halves them
    Cost(2**20 - 1, 2**25),
    Cost(2**22, 2**22),  # memory limits N: p is 8 and more
    Cost(2**20 + 12345, 3_000_000),
    Cost(100_000, 2**31),
]


@pytest.mark.skipif(LIBRARY is None, reason="libsodium is not installed: apt install libsodium23")
@pytest.mark.parametrize("cost", COSTS, ids=str)
def test_the_bytes_are_those_of_libsodium(cost):
    password, salt, stream = "Grüne Bremse", bytes(range(32)), ctypes.create_string_buffer(104)
    typed = password.encode()
    done = ctypes.CDLL(LIBRARY).crypto_pwhash_scryptsalsa208sha256(
        *(stream, ctypes.c_ulonglong(104), typed, ctypes.c_ulonglong(len(typed)), salt),
        *(ctypes.c_ulonglong(cost.work), ctypes.c_size_t(cost.memory)),
    )
    assert done == 0
    assert mask(password, salt, cost, 104, KeyFileError) == stream.raw


@pytest.mark.parametrize("memory", [2**31, 2**30, 12345678, 2**20, 1024, 1, 0])
@pytest.mark.parametrize("work", [2**28, 2**25, 2**15, 1, 0])
def test_no_cost_that_is_accepted_takes_more_memory_than_it_says(work, memory):
    cost = Cost(work, memory)
    check_cost(cost, KeyFileError)
    n, p = scrypt_numbers(cost)
    assert 128 * 8 * n <= max(memory, 2048)
    assert p >= 1
    assert 4 * 8 * n * p <= max(work, 2**15)


@pytest.mark.parametrize("password", ["two\nlines", "\r", "a\0b", "é" * 511 + "e", "\ud800"])
def test_a_password_that_minisign_cannot_read_is_refused_and_not_shown(files, password):
    with pytest.raises(KeyFileError, match="the password ") as refusal:
        generate(*files, password, CHEAP)
    assert password not in str(refusal.value)
    assert list(files[0].parent.iterdir()) == []


# New pairs.
@pytest.fixture
def files(tmp_path):
    return tmp_path / "car.key", tmp_path / "car.pub"


@pytest.mark.parametrize("password", ["", "Bremse 8", " ", "é" * 511, "\udcff"])
def test_a_new_pair_signs_and_verifies(files, password):
    secret, public = files
    made = generate(secret, public, password, CHEAP)
    key = read_secret_key(secret, (lambda: password) if password else never)
    assert made == key.public == read_public_key(public)
    signature = parse_signature(sign(key, b"data", "comment"))
    assert verify(made, b"data", signature) == "comment"


def test_only_the_owner_reads_the_secret_key(files):
    old = os.umask(0)
    try:
        generate(*files, "")
    finally:
        os.umask(old)
    assert [stat.S_IMODE(path.stat().st_mode) for path in files] == [0o600, 0o644]


def test_every_pair_is_new(tmp_path):
    made = [generate(tmp_path / f"{i}.key", tmp_path / f"{i}.pub", "") for i in range(20)]
    assert len({key.number for key in made}) == len({key.point for key in made}) == 20


@pytest.mark.parametrize("existing", [0, 1])
def test_an_existing_file_is_not_replaced(files, existing):
    files[existing].write_text("precious")
    with pytest.raises(KeyFileError, match="exists already") as refusal:
        generate(*files, "")
    assert str(files[existing]) in str(refusal.value)
    assert files[existing].read_text() == "precious"
    assert not files[1 - existing].exists()


@pytest.mark.parametrize("existing", [0, 1])
def test_a_file_that_comes_into_being_meanwhile_is_not_replaced(files, monkeypatch, existing):
    files[existing].write_text("precious")
    monkeypatch.setattr(os.path, "lexists", lambda _: False)
    with pytest.raises(KeyFileError, match="exists already"):
        generate(*files, "")
    assert files[existing].read_text() == "precious"
    assert not files[1 - existing].exists()


def test_a_link_to_nowhere_is_not_followed(files):
    files[0].symlink_to(files[0].with_name("elsewhere"))
    with pytest.raises(KeyFileError, match="exists already"):
        generate(*files, "")
    assert [path.name for path in files[0].parent.iterdir()] == ["car.key"]


def test_one_file_for_both_is_refused(files):
    with pytest.raises(KeyFileError, match="one file for both keys"):
        generate(files[0], files[0], "")
    assert not files[0].exists()


def test_a_folder_that_is_missing_leaves_nothing(tmp_path):
    with pytest.raises(KeyFileError, match=r"car\.pub: cannot be written"):
        generate(tmp_path / "car.key", tmp_path / "none" / "car.pub", "")
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize("write", [1, 2])
def test_a_full_disk_leaves_nothing(files, monkeypatch, write):
    done = []

    def full(handle):
        done.append(handle)
        if len(done) == write:
            raise OSError(28, "No space left on device")

    monkeypatch.setattr(os, "fsync", full)
    with pytest.raises(KeyFileError, match=r"cannot be written \(No space left on device\)"):
        generate(*files, "")
    assert list(files[0].parent.iterdir()) == []


# Without the extra.
SAYS = r"keys are used with cryptography, which is not installed; pip install 'brake-cal\[sign\]'$"


@pytest.fixture
def without(monkeypatch):
    """An environment without cryptography."""
    for name in [m for m in sys.modules if m.split(".")[0] == "cryptography"]:
        monkeypatch.delitem(sys.modules, name)

    class Absent:
        @staticmethod
        def find_spec(name, path=None, target=None):
            if name.split(".")[0] == "cryptography":
                raise ModuleNotFoundError(f"No module named {name!r}", name=name)

    monkeypatch.setattr(sys, "meta_path", [Absent, *sys.meta_path])


def test_the_extra_is_named(without, golden, key, content, tmp_path):
    public = read_public_key(golden / "open.pub")
    uses = [
        lambda: read_secret_key(golden / "open.key", never),
        lambda: read_secret_key(golden / "small.key", lambda: "password"),
        lambda: generate(tmp_path / "car.key", tmp_path / "car.pub", ""),
        lambda: verify(public, b"", parse_signature(content)),
    ]
    for use in uses:
        with pytest.raises(KeyFileError, match=SAYS):
            use()
    assert list(tmp_path.iterdir()) == []


def test_a_key_and_a_signature_are_read_without_it(without, golden, content):
    key = read_public_key(golden / "open.pub")
    assert parse_signature(content).key_id == key.key_id


def test_an_error_inside_the_library_is_not_hidden(monkeypatch):
    class Broken:
        @staticmethod
        def find_spec(name, path=None, target=None):
            if name == "cryptography.exceptions":
                raise ModuleNotFoundError("No module named 'cffi'", name="cffi")

    monkeypatch.delitem(sys.modules, "cryptography.exceptions", raising=False)
    monkeypatch.setattr(sys, "meta_path", [Broken, *sys.meta_path])
    public = read_public_key("RWQf6LRCGA9i53mlYecO4IzT51TGPpvWucNSCh1CBM0QTaLn73Y7GFO3")
    with pytest.raises(ModuleNotFoundError, match="cffi"):
        verify(public, b"", parse_signature(sign_with(public)))


def sign_with(public) -> bytes:
    """A signature file of the key's number; it does not hold."""
    return Signature(PREHASHED, public.number, bytes(64), "", bytes(64), "").file

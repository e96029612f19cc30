"""Public keys: the file and the word, and the keys that are refused."""

from base64 import b64encode

import pytest

from calib.errors import KeyFileError
from calib.signing.public_key import PublicKey, read_public_key

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


@pytest.fixture
def write(tmp_path):
    def write(content: bytes):
        path = tmp_path / "car.pub"
        path.write_bytes(content)
        return path

    return write


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


def test_line_ends_of_windows_are_read(golden, write):
    content = (golden / "open.pub").read_bytes()
    assert read_public_key(write(content.replace(b"\n", b"\r\n"))).file == content


def test_a_file_cut_at_any_place_is_refused(golden, write):
    content = (golden / "open.pub").read_bytes()
    for end in range(len(content)):
        with pytest.raises(KeyFileError, match=r"car\.pub: "):
            read_public_key(write(content[:end]))


@pytest.mark.parametrize(
    ("text", "says"),
    [
        (b"RW" + b"A" * 53, "not base64"),
        (b"RW" + b"A" * 53 + b"=", "41 bytes, not 42"),
        (b"RW" + b"A" * 58, "45 bytes, not 42"),
        (b"RW" + b"-" * 54, "not base64"),
        (b" RW" + b"A" * 53, "not base64"),
        (b"RW" + b"\xff" * 54, "not base64"),
        (b"", "0 bytes, not 42"),
        (b"RU" + b"A" * 54, "unknown algorithm"),
        (b"RW" + b"A" * 54 + b"\n", "has 3 lines"),
    ],
)
def test_a_hostile_file_is_refused_by_name(write, text, says):
    with pytest.raises(KeyFileError, match=says):
        read_public_key(write(b"untrusted comment: a key\n" + text + b"\n"))


def test_a_file_without_a_comment_is_refused(golden, write):
    word = (golden / "open.pub").read_bytes().split(b"\n")[1]
    with pytest.raises(KeyFileError, match="no untrusted comment"):
        read_public_key(write(b"my key\n" + word + b"\n"))


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

"""Keys of minisign: a public one, a secret one with or without a password, and a new pair.

A file has two lines, a comment and base64. The 42 bytes of a public key and the 158 bytes of a
secret one:

    "Ed" | number 8 | point 32
    "Ed" | "Sc" or zeros | "B2" | salt 32 | work 8 | memory 8 | number 8, secret 64, checksum 32
                                                                └── hidden by the password ──┘
"""

import hmac
import os
import re
import secrets
from base64 import b64encode
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from hashlib import blake2b
from pathlib import Path
from typing import Any, NoReturn

from calib.base.errors import KeyFileError
from calib.store.minisign_lines import (
    UNTRUSTED,
    Refuse,
    ed25519,
    file_of,
    need,
    parse_base64,
    parse_comment,
    read_small,
    spelled,
    split_lines,
)

ED25519 = b"Ed"
"""Opens a key: its algorithm."""

PUBLIC_SIZE, SECRET_SIZE, HIDDEN = 42, 158, 8 + 64 + 32
SCRYPT, OPEN, BLAKE2B = b"Sc", bytes(2), b"B2"
NO_CHECKSUM = bytes(32)
"""The checksum of a key that minisign 0.11 made without a password."""

_TEXT = re.compile(r"RW[A-Za-z0-9+/]{54}")
_PRIME = 2**255 - 19
_ORDER_8 = 0x7A03AC9277FDC74EC6CC392CFA53202A0F67100D760B3CBA4FD84D3D706A17C7
_WEAK = {0, 1, _PRIME - 1, _ORDER_8, _PRIME - _ORDER_8}
"""y of the eight points of small order of Ed25519: everybody can sign for such a key."""


@dataclass(frozen=True)
class PublicKey:
    """A public key: the key number (8 bytes) and the point of Ed25519 (32 bytes)."""

    number: bytes
    point: bytes

    @property
    def key_id(self) -> str:
        """The key number as minisign prints it."""
        return spelled(self.number)

    @property
    def text(self) -> str:
        """The key as one word of base64, as ``minisign -P`` takes it."""
        return b64encode(self._content).decode()

    @property
    def file(self) -> bytes:
        """The key as the content of a public key file."""
        return file_of(f"{UNTRUSTED}minisign public key {self.key_id}", self._content)

    @property
    def _content(self) -> bytes:
        return ED25519 + self.number + self.point


def read_public_key(source: Path | str) -> PublicKey:
    """Read a public key from a file, or from its base64 text of 56 characters.

    Raises KeyFileError if it cannot be read, is not a public key of minisign, or is one of the
    keys that everybody can sign for.
    """
    if isinstance(source, str) and _TEXT.fullmatch(source):
        return _parsed(source.encode(), partial(KeyFileError, where=f"public key {source}"))
    refuse = partial(KeyFileError, where=source)
    comment, text = split_lines(read_small(Path(source), refuse), 2, refuse)
    parse_comment(comment, UNTRUSTED, refuse)
    return _parsed(text, refuse)


def _parsed(text: bytes, refuse: Refuse) -> PublicKey:
    content = parse_base64(text, PUBLIC_SIZE, "public key", refuse)
    if content[:2] != ED25519:
        raise refuse("has an unknown algorithm", expected="Ed25519, the only one of minisign")
    height = int.from_bytes(content[10:], "little") & ~(1 << 255)
    if height >= _PRIME or height in _WEAK:
        raise refuse("is not a safe key: everybody can sign for it", do="ask for another key")
    return PublicKey(content[2:10], content[10:])


LONGEST = 1022
"""Bytes of a password that minisign reads from one line."""
MOST_MEMORY, MOST_WORK = 2**31, 2**28
"""Eight times the work of a key of minisign: about half a minute."""
BLOCK = 8
"""r of scrypt."""


@dataclass(frozen=True)
class Cost:
    """What a password costs to try: scrypt's work (operations) and memory (bytes)."""

    work: int
    memory: int


SENSITIVE = Cost(2**25, 2**30)
"""What minisign takes: 1 GiB, a few seconds."""


def check_cost(cost: Cost, refuse: Refuse) -> None:
    """Raise the error of ``refuse`` if the cost is more than a key of minisign can ask for."""
    if cost.memory > MOST_MEMORY:
        raise refuse(f"asks for {cost.memory / 2**30:.4g} GiB of memory", expected="at most 2 GiB")
    if cost.work > MOST_WORK:
        raise refuse(
            f"asks for {cost.work / SENSITIVE.work:.4g} times the work of a key of minisign",
            expected=f"at most {MOST_WORK // SENSITIVE.work} times",
        )


def mask(password: str, salt: bytes, cost: Cost, size: int, refuse: Refuse) -> bytes:
    """``size`` bytes that only the password gives; ``cost`` has passed `check_cost`.

    Raises the error of ``refuse`` if there is not enough memory.
    """
    n, p = scrypt_numbers(cost)
    scrypt = need("cryptography.hazmat.primitives.kdf.scrypt").Scrypt
    typed = _bytes_of(password, refuse)
    try:
        stream: bytes = scrypt(salt=salt, length=size, n=n, r=BLOCK, p=p).derive(typed)
    except MemoryError:
        needs = f"{128 * BLOCK * n / 2**20:.0f} MiB"
        raise refuse(f"its password needs {needs} of memory, which is not free") from None
    return stream


def scrypt_numbers(cost: Cost) -> tuple[int, int]:
    """N and p of scrypt for a cost, as `pickparams` of libsodium 1.0.18 has them.

    >>> scrypt_numbers(SENSITIVE)
    (1048576, 1)
    """
    work = max(cost.work, 2**15)
    by_work = work < cost.memory // 32
    most = work // (4 * BLOCK) if by_work else cost.memory // (128 * BLOCK)
    n = 2
    while n <= most // 2:
        n *= 2
    return n, 1 if by_work else min(work // 4 // n, 2**30 - 1) // BLOCK


def _bytes_of(password: str, refuse: Refuse) -> bytes:
    """The bytes that were typed; the error of the codec would show the password."""
    try:
        return password.encode("utf-8", "surrogateescape")
    except UnicodeEncodeError:
        raise refuse("the password is not text") from None


class SecretKey:
    """A secret key, ready to sign. Its text shows the key number only, and it cannot be copied."""

    __slots__ = ("_private", "public")

    def __init__(self, number: bytes, seed: bytes) -> None:
        """Make the key of a key number of 8 bytes and a secret of 32 bytes."""
        self._private: Any = ed25519().Ed25519PrivateKey.from_private_bytes(seed)
        self.public = PublicKey(number, self._private.public_key().public_bytes_raw())

    @property
    def key_id(self) -> str:
        """The key number as minisign prints it."""
        return self.public.key_id

    def signature_of(self, message: bytes) -> bytes:
        """The 64 bytes of the Ed25519 signature of a message (RFC 8032)."""
        signed: bytes = self._private.sign(message)
        return signed

    def __repr__(self) -> str:
        return f"SecretKey({self.key_id})"

    def __reduce__(self) -> NoReturn:
        raise TypeError("a secret key is not copied")


def read_secret_key(path: Path, password: Callable[[], str]) -> SecretKey:
    """Read a secret key file; ``password`` is called only if the file asks for one.

    Raises KeyFileError if the file cannot be read, is no secret key of minisign, is damaged, asks
    for more than 2 GiB of memory, or if the password is not its own. No message shows the key or
    the password.
    """
    refuse = partial(KeyFileError, where=path)
    comment, text = split_lines(read_small(path, refuse), 2, refuse)
    parse_comment(comment, UNTRUSTED, refuse)
    content = parse_base64(text, SECRET_SIZE, "secret key", refuse)
    if content[:2] != ED25519 or content[4:6] != BLAKE2B:
        raise refuse("has an unknown algorithm", expected="Ed25519 with BLAKE2b, as minisign has")
    if content[2:4] == OPEN:
        return _key(content[-HIDDEN:], False, refuse)
    if content[2:4] != SCRYPT:
        raise refuse("has an unknown protection", expected="scrypt, or none")
    cost = Cost(*(int.from_bytes(content[i : i + 8], "little") for i in (38, 46)))
    check_cost(cost, refuse)  # before anybody types a password
    stream = mask(password(), content[6:38], cost, HIDDEN, refuse)
    return _key(_xor(content[-HIDDEN:], stream), True, refuse)


def secret_file(number: bytes, seed: bytes) -> bytes:
    """The content of a secret key file without a password."""
    content = ED25519 + OPEN + BLAKE2B + bytes(32 + 8 + 8) + _hidden_part(number, seed)
    return file_of(f"{UNTRUSTED}minisign secret key without a password", content)


def locked_file(number: bytes, seed: bytes, password: str, salt: bytes, cost: Cost) -> bytes:
    """The content of a secret key file with a password; ``salt`` is 32 random bytes.

    Raises KeyFileError if there is not enough memory.
    """
    stream = mask(password, salt, cost, HIDDEN, KeyFileError)
    header = ED25519 + SCRYPT + BLAKE2B + salt
    limits = cost.work.to_bytes(8, "little") + cost.memory.to_bytes(8, "little")
    content = header + limits + _xor(_hidden_part(number, seed), stream)
    return file_of(f"{UNTRUSTED}minisign encrypted secret key", content)


def _hidden_part(number: bytes, seed: bytes) -> bytes:
    secret = seed + SecretKey(number, seed).public.point
    return number + secret + _checksum(number + secret)


def _checksum(number_and_secret: bytes) -> bytes:
    return blake2b(ED25519 + number_and_secret, digest_size=32).digest()


def _key(hidden: bytes, locked: bool, refuse: Refuse) -> SecretKey:
    """The key in the hidden part, once its checksum and its public half are found right."""
    found, checksum = hidden[:72], hidden[72:]
    unchecked = not locked and checksum == NO_CHECKSUM
    if not unchecked and not hmac.compare_digest(_checksum(found), checksum):
        what = "the password is wrong, or the file is damaged" if locked else "is damaged"
        raise refuse(f"{what}: the checksum does not match")
    key = SecretKey(found[:8], found[8:40])
    if not hmac.compare_digest(key.public.point, found[40:]):
        raise refuse("is damaged: the secret and the public half are not of one key")
    return key


def _xor(left: bytes, right: bytes) -> bytes:
    return bytes(a ^ b for a, b in zip(left, right, strict=True))


def generate(secret: Path, public: Path, password: str, cost: Cost = SENSITIVE) -> PublicKey:
    """Make a key pair and write it as minisign does; an empty password means none.

    Only its owner can read the file of the ``secret`` key. ``cost`` is what each try of the
    password takes. Raises KeyFileError if a file exists already or cannot be written, if the
    password cannot be typed into minisign, or without enough memory. No file is left then.
    """
    content = _bytes_of(password, KeyFileError)
    if any(sign in content for sign in b"\0\r\n"):
        raise KeyFileError("the password has a line end or a zero character")
    if len(content) > LONGEST:
        raise KeyFileError(f"the password has {len(content)} bytes", expected=f"at most {LONGEST}")
    if secret.absolute() == public.absolute():
        raise KeyFileError("one file for both keys", where=secret, expected="two files")
    for path in (secret, public):
        if os.path.lexists(path):
            raise _exists(path)
    number, seed = secrets.token_bytes(8), secrets.token_bytes(32)
    if password:
        written = locked_file(number, seed, password, secrets.token_bytes(32), cost)
    else:
        written = secret_file(number, seed)
    key = SecretKey(number, seed).public
    _write_new(secret, written, 0o600)
    try:
        _write_new(public, key.file, 0o644)
    except KeyFileError:
        secret.unlink()
        raise
    return key


def _exists(path: Path) -> KeyFileError:
    return KeyFileError(
        "exists already", where=path, do="choose another name: a key is not replaced"
    )


def _write_new(path: Path, content: bytes, mode: int) -> None:
    """Write a file that must not exist; nothing of it is left if that fails."""
    try:
        with open(path, "xb", opener=lambda name, flags: os.open(name, flags, mode)) as file:
            try:
                file.write(content)
                file.flush()
                os.fsync(file.fileno())
            except BaseException:
                path.unlink(missing_ok=True)
                raise
    except FileExistsError:
        raise _exists(path) from None
    except OSError as error:
        raise KeyFileError(f"cannot be written ({error.strerror})", where=path) from None

"""Secret keys of minisign: a file of two lines, with or without a password.

The 158 bytes of its second line:

    "Ed" | "Sc" or zeros | "B2" | salt 32 | work 8 | memory 8 | number 8, secret 64, checksum 32
                                                                └── hidden by the password ──┘
"""

import hmac
from collections.abc import Callable
from functools import partial
from hashlib import blake2b
from pathlib import Path
from typing import Any, NoReturn

from calib.errors import KeyFileError
from calib.signing.library import ed25519
from calib.signing.lines import (
    UNTRUSTED,
    Refuse,
    file_of,
    parse_base64,
    parse_comment,
    read_small,
    split_lines,
)
from calib.signing.password import Cost, check_cost, mask
from calib.signing.public_key import ED25519, PublicKey

SCRYPT, OPEN, BLAKE2B = b"Sc", bytes(2), b"B2"
SIZE = 158
HIDDEN = 8 + 64 + 32
NO_CHECKSUM = bytes(32)
"""The checksum of a key that minisign 0.11 made without a password."""


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
    content = parse_base64(text, SIZE, "secret key", refuse)
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
    header = ED25519 + OPEN + BLAKE2B + bytes(32 + 8 + 8)
    return file_of(
        f"{UNTRUSTED}minisign secret key without a password",
        header + _hidden_part(number, seed),
    )


def locked_file(number: bytes, seed: bytes, password: str, salt: bytes, cost: Cost) -> bytes:
    """The content of a secret key file with a password; ``salt`` is 32 random bytes.

    Raises KeyFileError if there is not enough memory.
    """
    stream = mask(password, salt, cost, HIDDEN, KeyFileError)
    header = ED25519 + SCRYPT + BLAKE2B + salt
    limits = cost.work.to_bytes(8, "little") + cost.memory.to_bytes(8, "little")
    return file_of(
        f"{UNTRUSTED}minisign encrypted secret key",
        header + limits + _xor(_hidden_part(number, seed), stream),
    )


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

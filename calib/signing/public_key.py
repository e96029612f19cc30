"""Public keys of minisign: a file of two lines, or its second line alone."""

import re
from base64 import b64encode
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from calib.errors import KeyFileError
from calib.signing.lines import (
    UNTRUSTED,
    Refuse,
    file_of,
    parse_base64,
    parse_comment,
    read_small,
    spelled,
    split_lines,
)

ED25519 = b"Ed"
"""Opens a key: its algorithm."""

SIZE = 2 + 8 + 32
"""Bytes of a public key: algorithm, key number, point."""

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
    content = parse_base64(text, SIZE, "public key", refuse)
    if content[:2] != ED25519:
        raise refuse("has an unknown algorithm", expected="Ed25519, the only one of minisign")
    height = int.from_bytes(content[10:], "little") & ~(1 << 255)
    if height >= _PRIME or height in _WEAK:
        raise refuse("is not a safe key: everybody can sign for it", do="ask for another key")
    return PublicKey(content[2:10], content[10:])

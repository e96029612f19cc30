"""Blocks of an MDF 4 file in memory, and where they begin.

##XX  4 bytes unused  length  number of links  links  content
"""

import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from mmap import mmap
from pathlib import Path

from calib.errors import LogError

Bytes = bytes | bytearray | mmap
"""The content of a file."""

_BLOCK = struct.Struct("<4s4xQQ")
_FIRST = 64


@dataclass(frozen=True)
class Block:
    """``kind`` such as ``b"##DG"``, ``length`` [bytes], ``links``, where ``content`` begins."""

    kind: bytes
    length: int
    links: tuple[int, ...]
    content: int


@contextmanager
def whole_blocks(path: Path) -> Iterator[None]:
    """Raise LogError where a block of the file turns out to be shorter than its kind."""
    try:
        yield
    except (struct.error, IndexError) as cause:
        raise LogError(
            f"a block is shorter than its kind: {cause}",
            where=path,
            expected="an undamaged file",
            do="copy the log again",
        ) from cause


def block_at(data: Bytes, place: int) -> Block:
    """The block that begins at a byte. `calib.logs.mdf.size` must have followed the links."""
    kind, length, links = _BLOCK.unpack_from(data, place)
    begin = place + _BLOCK.size
    return Block(kind, length, struct.unpack_from(f"<{links}Q", data, begin), begin + 8 * links)


def places(data: Bytes) -> set[int]:
    """First bytes of all blocks that links lead to."""
    seen, todo = set[int](), [_FIRST]
    while todo:
        place = todo.pop()
        if place and place not in seen:
            seen.add(place)
            todo += block_at(data, place).links
    return seen


def chain(data: Bytes, place: int) -> Iterator[int]:
    """First bytes of a block and of those that follow it by their first link, each once."""
    seen = set[int]()
    while place and place not in seen:
        seen.add(place)
        yield place
        place = block_at(data, place).links[0]

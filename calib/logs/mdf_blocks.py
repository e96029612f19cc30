"""Blocks of an MDF file: each has a length and links to others, by byte.

MDF 4   ##XX  4 bytes unused  length  number of links  links  content
MDF 3   a data group links to its data, of length records times record size
"""

import mmap
import struct
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import BinaryIO

from calib.base.errors import LogError
from calib.logs.source import damaged

COUNTS, LAST_LENGTH, VLSD_SIZES = 1, 4, 32
"""Flags of what a recorder left: counts of groups, length of the last DT, sizes of VLSD groups."""
HEAD = 64
"""Bytes of the identification block, after which the first block begins."""
_BLOCK = struct.Struct("<4s4xQQ")
_MOST_LINKS = 10_000_000


@dataclass(frozen=True)
class Block:
    """``kind`` such as ``b"##DG"``, ``length`` [bytes], ``links``, where ``content`` begins."""

    kind: bytes
    length: int
    links: tuple[int, ...]
    content: int


@dataclass(frozen=True)
class Identification:
    """Version of the format, and the flags of what the recorder did not finish, 0 if nothing."""

    version: str
    flags: int
    little_endian: bool


def not_finished(path: Path, why: str, expected: str) -> LogError:
    """The error for a file that its recorder left so that it cannot be finished here."""
    return LogError(
        f"the recorder did not finish the file (UnFinMF), {why}",
        where=path,
        expected=expected,
        do="finish it with the recorder's own tool, or open and save it with an MDF editor",
    )


def identification(file: BinaryIO, size: int, path: Path) -> Identification:
    """Read the first block. Raises LogError for what is not MDF, or not finished in another way."""
    data = file.read(HEAD)
    begin, version = data[:8].rstrip(b" \0"), data[8:12].strip(b" \0")
    unfinished = begin == b"UnFinMF"
    flags = int.from_bytes(data[60:62], "little") if unfinished else 0
    if unfinished:
        known = flags and not flags & ~(COUNTS | LAST_LENGTH | VLSD_SIZES)
        if not known or len(data) < HEAD or not b"4.10" <= version < b"5":
            why = "so its counts are not final"
            expected = "a finished file, or one that lacks only counts and the length of its data"
            raise not_finished(path, why, expected)
    elif begin != b"MDF":
        raise LogError("not an MDF file", where=path, expected="a file that begins with MDF")
    if len(data) < HEAD:
        raise _short(path, size, HEAD)
    if not version.isascii() or version[:1] not in (b"2", b"3", b"4"):
        text = version.decode(errors="replace")
        raise LogError(f"MDF version {text!r}", where=path, expected="3.x or 4.x")
    return Identification(version.decode(), flags, data[24:26] == b"\0\0")


@contextmanager
def whole_blocks(path: Path) -> Iterator[None]:
    """Raise LogError where a block turns out to be shorter than its kind, or links go round."""
    try:
        yield
    except (struct.error, IndexError, ValueError, OverflowError) as cause:
        what = f"a block is shorter than its kind, or links go round: {cause}"
        raise damaged(path, what) from cause


def block_at(data: mmap.mmap, place: int) -> Block:
    """The block of MDF 4 that begins at a byte."""
    kind, length, links = _BLOCK.unpack_from(data, place)
    begin = place + _BLOCK.size
    return Block(kind, length, struct.unpack_from(f"<{links}Q", data, begin), begin + 8 * links)


def chain(data: mmap.mmap, place: int) -> Iterator[tuple[int, Block]]:
    """A block and those that follow it by their first link. Raises ValueError for a ring."""
    seen = set[int]()
    while place:
        refuse_again(place, seen)
        block = block_at(data, place)
        yield place, block
        place = block.links[0]


def refuse_again(place: int, seen: set[int]) -> None:
    """Raise ValueError for a block that was met before: links in a ring have no end."""
    if place in seen:
        raise ValueError(f"a second link to byte {place}")
    seen.add(place)


def check_4(data: mmap.mmap, path: Path) -> set[int]:
    """First bytes of all blocks of MDF 4. Raises LogError if one goes past the end of the file."""
    seen, todo, end, size = set[int](), [HEAD], HEAD, len(data)
    while todo:
        place = todo.pop()
        if place in seen or place == 0:
            continue
        seen.add(place)
        end = max(end, place + _BLOCK.size)
        if place + _BLOCK.size > size:
            continue
        kind, length, links = _BLOCK.unpack_from(data, place)
        if kind[:2] != b"##" or links > _MOST_LINKS or length < _BLOCK.size + 8 * links:
            raise _no_block(path, "block", place)
        end = max(end, place + length)
        if links and place + _BLOCK.size + 8 * links <= size:
            todo += struct.unpack_from(f"<{links}Q", data, place + _BLOCK.size)
    if end > size:
        raise _short(path, size, end)
    return seen


def check_3(file: BinaryIO, little_endian: bool, size: int, path: Path) -> None:
    """Follow groups and channels of MDF 3; the length of the data follows from its records."""
    end = HEAD
    seen = set[int]()
    ranges: list[tuple[int, int]] = []

    def block(place: int, kind: bytes, form: str) -> tuple[int, ...]:
        nonlocal end
        if place in seen:
            raise _no_block(path, "block that was not met before", place)
        seen.add(place)
        layout = struct.Struct(f"{'<' if little_endian else '>'}2sH{form}")
        end = max(end, place + layout.size)
        if place + layout.size > size:
            raise _short(path, size, end)
        file.seek(place)
        found, length, *rest = layout.unpack(file.read(layout.size))
        if found != kind:
            raise _no_block(path, f"{kind.decode()} block", place)
        end = max(end, place + length)
        return tuple(rest)

    (group,) = block(HEAD, b"HD", "I")
    while group:
        group, channels, _, data, _, ids = block(group, b"DG", "IIIIHH")
        needed = 0
        while channels:
            channels, channel, _, _, _, width, count = block(channels, b"CG", "IIIHHHI")
            needed += count * (width + ids)
            while channel:
                channel, *others = block(channel, b"CN", "IIIII")
                end = max([end, *(o + 4 for o in others)])
        ranges += [(data, data + needed)] if data and needed else []
    end = max([end, *(stop for _, stop in ranges)])
    if end > size:
        raise _short(path, size, end)
    ranges.sort()
    for (begin, stop), (following, _) in pairwise(ranges):
        if stop > following > begin:
            what = (
                f"{following - begin} of {stop - begin} bytes of samples come before those of "
                f"another group: {stop - following} are missing"
            )
            raise damaged(path, what, "as many samples as each group counts")


def _short(path: Path, size: int, end: int) -> LogError:
    what = (
        f"cut off: the file has {size} bytes, its blocks need {end}; at least {end - size} "
        f"are missing ({100 * (1 - size / end):.0f} % of the file)"
    )
    return damaged(path, what, "a complete file")


def _no_block(path: Path, what: str, place: int) -> LogError:
    return damaged(path, f"there should be a {what} at byte {place}, but there is none")

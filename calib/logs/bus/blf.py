"""Vector BLF, read with python-can; size and object count are compared with the header.

header   LOGG, size of the file, number of objects, time of start and stop
container LOBJ type 10, compressed
    object LOBJ, size, type ...      may continue in the next container
"""

import struct
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from calib.errors import LogError
from calib.logs.bus.recording import gathered, recording, require_dbc
from calib.logs.extra import need
from calib.logs.recording import Recording

_HEADER = struct.Struct("<4sL8xQQL")
_OBJECT = struct.Struct("<4sHHLL")
_CONTAINER, _CONTAINER_HEADER, _DEFLATE = 10, 16, 2
_MOST_UNPACKED = 64_000_000
"""Bytes of one container; those of Vector have 128 kB."""
_FRAMES = frozenset((1, 86, 73, 100, 101))
"""Types of objects that are frames: classic, classic 2, error, FD, FD 64."""


@dataclass(frozen=True)
class Objects:
    """Number of ``all`` objects, and of the ``frames`` among them."""

    all: int
    frames: int


def open_blf(path: Path, dbc: Sequence[Path]) -> Recording:
    """Open a BLF file.

    Raises LogError for a file whose size or number of objects differs from its header (python-can
    reads such a file without an error), if python-can or a DBC is missing, and if no frame is
    described by the DBC.
    """
    where = str(path)
    can = need("can", "can", where)
    known = require_dbc(dbc, "can", where)
    objects = check_whole(path)
    with can.BLFReader(path) as reader:
        found = gathered(reader, known, where)
    if len(found.times) != objects.frames:
        raise LogError(
            f"{len(found.times)} of {objects.frames} frames can be read: "
            f"{objects.frames - len(found.times)} are missing",
            where=where,
            expected="all of them",
            do="copy the log again",
        )
    return recording(found, known, (), where)


def check_whole(path: Path) -> Objects:
    """Compare size and number of objects with the header. Raises LogError."""
    size = path.stat().st_size
    with path.open("rb") as file:
        begin = file.read(_HEADER.size)
        if len(begin) < _HEADER.size or begin[:4] != b"LOGG":
            raise LogError("not a BLF file", where=path, expected="a file that begins with LOGG")
        _, first, promised, _, count = _HEADER.unpack(begin)
        if not count:
            raise LogError(
                "the recorder did not finish the file: its header counts no objects",
                where=path,
                expected="a header with size and count, to compare with what is there",
                do="open it with the tool that wrote it and save it again",
            )
        if size < promised:
            raise LogError(
                f"the file has {size} of {promised} bytes: {promised - size} are missing "
                f"({100 * (1 - size / promised):.0f} % of the file)",
                where=path,
                expected=f"the {count} objects that its header counts",
                do="copy the log again",
            )
        file.seek(first)
        objects = _count(file, path)
    if objects.all != count:
        raise LogError(
            f"the file has {objects.all} of {count} objects: {count - objects.all} are missing",
            where=path,
            expected="as many as the header counts",
            do="copy the log again",
        )
    return objects


def _count(file: BinaryIO, path: Path) -> Objects:
    """Count all objects, also those in containers."""
    total = frames = 0
    rest = b""
    for kind, content in _outer(file, path):
        if kind != _CONTAINER:
            total, frames = total + 1, frames + (kind in _FRAMES)
            continue
        rest += _inflated(content, path)
        kinds, rest = _inner(rest)
        total, frames = total + len(kinds), frames + sum(k in _FRAMES for k in kinds)
    return Objects(total, frames)


def _outer(file: BinaryIO, path: Path) -> Iterator[tuple[int, bytes]]:
    """Type and content of the top-level objects of the file."""
    while head := file.read(_OBJECT.size):
        if len(head) < _OBJECT.size or head[:4] != b"LOBJ":
            if not head.strip(b"\0"):
                return
            raise _damaged(path, file.tell())
        _, _, _, size, kind = _OBJECT.unpack(head)
        content = file.read(size - _OBJECT.size) if size > _OBJECT.size else b""
        if len(content) < size - _OBJECT.size:
            raise _damaged(path, file.tell())
        file.read(size % 4)
        yield kind, content


def _inflated(content: bytes, path: Path) -> bytes:
    method = int.from_bytes(content[:2], "little")
    if method != _DEFLATE:
        return content[_CONTAINER_HEADER:]
    stream = zlib.decompressobj()
    try:
        unpacked = stream.decompress(content[_CONTAINER_HEADER:], _MOST_UNPACKED)
    except zlib.error as cause:
        raise LogError(
            f"a container cannot be unpacked: {cause}", where=path, do="copy the log again"
        ) from cause
    if stream.unconsumed_tail:
        raise LogError(
            f"a container unpacks to more than {_MOST_UNPACKED} bytes",
            where=path,
            expected="containers of some 128 kB",
        )
    return unpacked


def _inner(data: bytes) -> tuple[list[int], bytes]:
    """Types of the complete objects, and the bytes of an object that is not complete yet."""
    kinds: list[int] = []
    place = 0
    while True:
        found = data.find(b"LOBJ", place, place + 8)
        if found < 0 or found + _OBJECT.size > len(data):
            return kinds, data[place:]
        _, _, _, size, kind = _OBJECT.unpack_from(data, found)
        if found + size > len(data) or size < _OBJECT.size:
            return kinds, data[place:]
        kinds.append(kind)
        place = found + size


def _damaged(path: Path, place: int) -> LogError:
    return LogError(
        f"damaged near byte {place}", where=path, expected="an object", do="copy the log again"
    )

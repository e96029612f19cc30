"""Vector BLF, read with python-can; the sizes in its header are compared with what is there.

header   LOGG, size of the file, size of all objects unpacked, number of objects, start and stop
container LOBJ type 10, method, size of its content, content
    object LOBJ, size, type ...      may continue in the next container

The number of objects is only a hint: Vector's writers leave out objects of type 115, python-can
counts them.
"""

import struct
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from calib.base.errors import LogError
from calib.logs.bus.recording import gathered, recording, require_dbc
from calib.logs.channel_map import Databases
from calib.logs.source import Recording, damaged, need

_OBJECT = struct.Struct("<4sHHLL")
_CONTAINER, _DEFLATE = 10, 2
_MOST_UNPACKED = 64_000_000
"""Bytes of one container; those of Vector have 128 kB."""
_CONTENT = struct.Struct("<H6xL4x")
"""Begin of a container: its method of compression, and the size of what it contains."""
_FRAMES = frozenset((1, 86, 73, 100, 101))
"""Types of objects that are frames: classic, classic 2, error, FD, FD 64."""
_NEXT = 8
"""The next object begins at most this many bytes after the end of the one before."""


@dataclass
class _Found:
    """Numbers of objects and frames, and sizes in bytes.

    ``unpacked`` counts the objects of the file, with the containers unpacked; ``padding`` the bytes
    that may fill the space after them; ``rest`` is an object that is not complete.
    """

    objects: int = 0
    frames: int = 0
    unpacked: int = 0
    padding: int = 0
    rest: bytes = b""

    def take(self, kinds: Sequence[int]) -> None:
        """Count objects of these types."""
        self.objects += len(kinds)
        self.frames += sum(kind in _FRAMES for kind in kinds)


def _walk(file: BinaryIO, path: Path) -> _Found:
    """Count all objects from the position of ``file`` on, also those in containers.

    Raises LogError for damage, and for a container that holds less than it states.
    """
    found = _Found()
    for kind, content in _outer(file, path):
        found.unpacked += _OBJECT.size
        found.padding += len(content) % 4
        if kind != _CONTAINER:
            found.take([kind])
            found.unpacked += len(content)
            continue
        inner = _inflated(content, path)
        found.unpacked += _CONTENT.size + len(inner)
        kinds, found.rest = _inner(found.rest + inner, path)
        found.take(kinds)
    return found


def _outer(file: BinaryIO, path: Path) -> Iterator[tuple[int, bytes]]:
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
    """Unpack a container. Raises LogError if it ends early or holds less than it states."""
    if len(content) < _CONTENT.size:
        raise _container(path, "it has no header")
    method, size = _CONTENT.unpack_from(content)
    packed = content[_CONTENT.size :]
    if method == _DEFLATE:
        stream = zlib.decompressobj()
        try:
            packed = stream.decompress(packed, _MOST_UNPACKED)
        except zlib.error as cause:
            raise _container(path, str(cause)) from cause
        if stream.unconsumed_tail:
            raise _container(path, f"it unpacks to more than {_MOST_UNPACKED} bytes")
        if not stream.eof:
            raise _container(path, f"it ends after {len(packed)} of {size} bytes")
    if len(packed) < size:
        raise _container(path, f"it holds {len(packed)} of {size} bytes")
    return packed


def _inner(data: bytes, path: Path) -> tuple[list[int], bytes]:
    """Types of the complete objects, and the bytes of an object that is not complete yet."""
    kinds: list[int] = []
    place = 0
    while True:
        found = data.find(b"LOBJ", place, place + _NEXT)
        if found < 0 and len(data) - place > _NEXT:
            raise _container(path, f"no object after {len(kinds)} whole ones")
        if found < 0 or found + _OBJECT.size > len(data):
            return kinds, data[place:]
        _, _, _, size, kind = _OBJECT.unpack_from(data, found)
        if size < _OBJECT.size:
            raise _container(path, f"an object of {size} bytes after {len(kinds)} whole ones")
        if found + size > len(data):
            return kinds, data[place:]
        kinds.append(kind)
        place = found + size


def _container(path: Path, why: str) -> LogError:
    return damaged(path, f"a container cannot be unpacked: {why}", "whole containers")


def _damaged(path: Path, place: int) -> LogError:
    return damaged(path, f"damaged near byte {place}", "an object")


_HEADER = struct.Struct("<4sL8xQQL36x")


@dataclass(frozen=True)
class Objects:
    """Number of ``all`` objects, of the ``frames`` among them, and the number in the header."""

    all: int
    frames: int
    counted: int

    @property
    def notes(self) -> tuple[str, ...]:
        """A note if the header counts another number of objects."""
        if self.all == self.counted:
            return ()
        return (
            f"the header counts {self.counted} objects, the file has {self.all}: all sizes agree, "
            "so none is missing (writers differ in what they count)",
        )


def open_blf(path: Path, dbc: Databases) -> Recording:
    """Open a BLF file.

    Raises LogError for a file that is not whole (`check_whole`; python-can reads such a file
    without an error), if python-can or a DBC is missing, and if no frame is described by the DBC.
    """
    where = str(path)
    can = need("can", "can", where)
    known = require_dbc(dbc, "can", where)
    objects = check_whole(path)
    with can.BLFReader(path) as reader:
        found = gathered(reader, known, where)
    if len(found.times) != objects.frames:
        raise damaged(
            where,
            f"{len(found.times)} of {objects.frames} frames can be read: "
            f"{objects.frames - len(found.times)} are missing",
            "all of them",
        )
    return recording(found, known, objects.notes, where)


def check_whole(path: Path) -> Objects:
    """Compare the sizes in the header and in the containers with what is there.

    The number of objects decides only if the header has no size of the unpacked objects. Raises
    LogError for a file that is not BLF, not finished, damaged or not whole.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        begin = file.read(_HEADER.size)
        if len(begin) < _HEADER.size or begin[:4] != b"LOGG":
            raise LogError("not a BLF file", where=path, expected="a file that begins with LOGG")
        _, first, promised, unpacked, count = _HEADER.unpack(begin)
        if not promised or not (unpacked or count):
            raise LogError(
                "the recorder did not finish the file: its header counts no objects",
                where=path,
                expected="a header with sizes, to compare with what is there",
                do="open it with the tool that wrote it and save it again",
            )
        if size < promised:
            raise damaged(
                path,
                f"the file has {size} of {promised} bytes: {promised - size} are missing "
                f"({100 * (1 - size / promised):.0f} % of the file)",
                f"the {count} objects that its header counts",
            )
        file.seek(first)
        found = _walk(file, path)
    found.unpacked += first
    _require_all(found, unpacked, count, path)
    return Objects(found.objects, found.frames, count)


def _require_all(found: _Found, unpacked: int, count: int, path: Path) -> None:
    """Raise LogError for less than the header states, or an object that is not complete.

    ``found.padding`` is allowed for, because writers may count it or not.
    """
    short = unpacked - found.unpacked - found.padding
    if short > 0 or (not unpacked and found.objects < count):
        sizes = f"{found.unpacked} of {unpacked} bytes (unpacked) and " if unpacked else ""
        raise damaged(
            path,
            f"the file has {sizes}{found.objects} of {count} objects: some are missing",
            "as much as the header states",
        )
    if found.rest.strip(b"\0"):
        raise damaged(
            path,
            f"the last object is not complete, after {found.objects} whole ones",
            "whole objects",
        )

"""The objects of a BLF file: how many are there, and how many bytes they have unpacked.

container LOBJ type 10, method, size of its content, content
    object LOBJ, size, type ...      may continue in the next container
"""

import struct
import zlib
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import BinaryIO

from calib.errors import LogError

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
class FoundObjects:
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


def walk(file: BinaryIO, path: Path) -> FoundObjects:
    """Count all objects from the position of ``file`` on, also those in containers.

    Raises LogError for damage, and for a container that holds less than it states.
    """
    found = FoundObjects()
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
    return LogError(
        f"a container cannot be unpacked: {why}",
        where=path,
        expected="whole containers",
        do="copy the log again",
    )


def _damaged(path: Path, place: int) -> LogError:
    return LogError(
        f"damaged near byte {place}", where=path, expected="an object", do="copy the log again"
    )

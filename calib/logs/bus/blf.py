"""Vector BLF, read with python-can, which says nothing of a file that is not whole.

header    LOGG, size of the file, size of all objects unpacked, number of objects, start and stop
container LOBJ type 10, method, size of its content, content
    object LOBJ, size, type ...      may continue in the next container

The sizes are compared with what is there. The number of objects is only a hint: Vector's writers
leave out objects of type 115, python-can counts them.
"""

import struct
import zlib
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from calib.base.errors import LogError
from calib.logs.bus.recording import gathered, recording, require_dbc
from calib.logs.channel_map import Databases
from calib.logs.source import Recording, damaged, need

_HEADER = struct.Struct("<4sL8xQQL36x")
_OBJECT = struct.Struct("<4sHHLL")
_CONTENT = struct.Struct("<H6xL4x")
"""Begin of a container: its method of compression, and the size of what it contains."""
_CONTAINER, _DEFLATE = 10, 2
_MOST_UNPACKED = 64_000_000
"""Bytes of one container; those of Vector have 128 kB."""
_FRAMES = (1, 86, 73, 100, 101)
"""Types of objects that are frames: classic, classic 2, error, FD, FD 64."""
_NEXT = 8
"""The next object begins at most this many bytes after the end of the one before."""


def open_blf(path: Path, dbc: Databases) -> Recording:
    """Open a BLF file. Raises LogError as `check_whole` and `open_asc`."""
    where = str(path)
    can = need("can", "can", where)
    known = require_dbc(dbc, "can", where)
    frames, notes = check_whole(path)
    with path.open("rb") as file, can.BLFReader(file) as reader:
        found = gathered(reader, known, where)
    if len(found.times) != frames:
        raise damaged(where, f"{len(found.times)} of {frames} frames can be read", "all of them")
    return recording(found, known, notes, where)


def check_whole(path: Path) -> tuple[int, tuple[str, ...]]:
    """Compare the sizes in the header and in the containers with what is there.

    Returns the number of frames, and a note if the header counts another number of objects. Raises
    LogError for a file that is not BLF, not finished, damaged or not whole.
    """
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
        size = file.seek(0, 2)
        if size < promised:
            share = f"{100 * (1 - size / promised):.0f} % of the file"
            what = f"{size} of {promised} bytes: {promised - size} are missing ({share})"
            raise damaged(path, f"the file has {what}", f"the {count} objects of its header")
        file.seek(first)
        found = _walk(file, size, path)
    objects = found.kinds.total()
    # Writers may count the bytes that fill the space between objects or not.
    short = unpacked - first - found.unpacked - found.padding
    if short > 0 or (not unpacked and objects < count):
        sizes = f"{unpacked - short} of {unpacked} bytes (unpacked) and " if unpacked else ""
        what = f"the file has {sizes}{objects} of {count} objects: some are missing"
        raise damaged(path, what, "as much as the header states")
    if found.rest.strip(b"\0"):
        what = f"the last object is not complete, after {objects} whole ones"
        raise damaged(path, what, "whole objects")
    note = (
        f"the header counts {count} objects, the file has {objects}: all sizes agree, "
        "so none is missing (writers differ in what they count)"
    )
    return sum(found.kinds[kind] for kind in _FRAMES), (note,) if objects != count else ()


@dataclass
class _Found:
    """Objects by type, ``unpacked`` bytes of all, ``padding`` after them, ``rest`` of the last."""

    kinds: Counter[int] = field(default_factory=Counter)
    unpacked: int = 0
    padding: int = 0
    rest: bytes = b""


def _walk(file: BinaryIO, end: int, path: Path) -> _Found:
    """All objects from the position of ``file`` to its ``end``, also those in containers."""
    found = _Found()
    while (head := file.read(_OBJECT.size)).strip(b"\0"):
        whole = len(head) == _OBJECT.size and head[:4] == b"LOBJ"
        size, kind = _OBJECT.unpack(head)[3:] if whole else (0, 0)
        if not whole or size - _OBJECT.size > end - file.tell():
            raise damaged(path, f"damaged near byte {file.tell()}", "an object")
        content = file.read(max(size - _OBJECT.size, 0))
        file.read(size % 4)
        found.unpacked += _OBJECT.size
        found.padding += len(content) % 4
        if kind == _CONTAINER:
            found.unpacked += _CONTENT.size
            content = _inflated(content, path)
            found.rest = _count(found.rest + content, found.kinds, path)
        else:
            found.kinds[kind] += 1
        found.unpacked += len(content)
    return found


def _inflated(content: bytes, path: Path) -> bytes:
    if len(content) < _CONTENT.size:
        raise _container(path, "it has no header")
    method, size = _CONTENT.unpack_from(content)
    packed, whole = content[_CONTENT.size :], True
    if method == _DEFLATE:
        stream = zlib.decompressobj()
        try:
            packed = stream.decompress(packed, _MOST_UNPACKED)
        except zlib.error as cause:
            raise _container(path, str(cause)) from cause
        whole = stream.eof
    if not whole or len(packed) < size:
        raise _container(path, f"it holds {len(packed)} of {size} bytes")
    return packed


def _count(data: bytes, kinds: Counter[int], path: Path) -> bytes:
    """Count the complete objects; returns the bytes of one that is not complete yet."""
    place = 0
    while True:
        found = data.find(b"LOBJ", place, place + _NEXT)
        if found < 0 and len(data) - place > _NEXT:
            raise _container(path, f"no object after {kinds.total()} whole ones")
        if found < 0 or found + _OBJECT.size > len(data):
            return data[place:]
        size, kind = _OBJECT.unpack_from(data, found)[3:]
        if size < _OBJECT.size:
            raise _container(path, f"an object of {size} bytes")
        if found + size > len(data):
            return data[place:]
        kinds[kind] += 1
        place = found + size


def _container(path: Path, why: str) -> LogError:
    return damaged(path, f"a container cannot be unpacked: {why}", "whole containers")

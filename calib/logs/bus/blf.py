"""Vector BLF, read with python-can, which does not report a file that is not whole.

header    LOGG, size of the file, size of all objects unpacked, number of objects, start and stop
container LOBJ type 10, method, size of its content, content
    object LOBJ, size, type ...      may continue in the next container

The sizes are compared with the content. The number of objects is only a hint: Vector's writers
leave out objects of type 115, python-can counts them.
"""

import struct
import zlib
from collections import Counter
from dataclasses import dataclass, field
from pathlib import Path
from typing import BinaryIO

from calib.base.errors import LogError
from calib.base.extras import need
from calib.logs.bus.recording import captured, recording, require_dbc
from calib.logs.channel_map import Databases
from calib.logs.source import Recording, damaged

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
    """Open a BLF file. Raises LogError as `_check_whole` and `open_text_log`."""
    where = str(path)
    can = need("can", "can", where, LogError)
    database = require_dbc(dbc, "can", where)
    count, notes = _check_whole(path)
    with path.open("rb") as file, can.BLFReader(file) as reader:
        frames = captured(reader, database, where)
    if len(frames.times) != count:
        raise damaged(where, f"{len(frames.times)} of {count} frames can be read", "all of them")
    return recording(frames, database, notes, where)


def _check_whole(path: Path) -> tuple[int, tuple[str, ...]]:
    """Compare the sizes in the header and in the containers with what the file contains.

    Returns the number of frames, and a note if the header counts another number of objects. Raises
    LogError for a file that is not BLF, not finished, damaged or not whole.
    """
    with path.open("rb") as file:
        head = file.read(_HEADER.size)
        if len(head) < _HEADER.size or head[:4] != b"LOGG":
            raise LogError("not a BLF file", where=path, expected="a file that begins with LOGG")
        _, first, promised, unpacked, count = _HEADER.unpack(head)
        if not promised or not (unpacked or count):
            raise LogError(
                "the recorder did not finish the file: its header counts no objects",
                where=path,
                expected="a header with sizes, to compare with the content",
                do="open it with the tool that wrote it and save it again",
            )
        size = file.seek(0, 2)
        if size < promised:
            share = f"{100 * (1 - size / promised):.0f} % of the file"
            missing = f"{size} of {promised} bytes: {promised - size} are missing ({share})"
            raise damaged(path, f"the file has {missing}", f"the {count} objects of its header")
        file.seek(first)
        content = _walk(file, size, path)
    objects = content.kinds.total()
    # Some writers count the padding between objects, some do not.
    lacking = unpacked - first - content.unpacked - content.padding
    if lacking > 0 or (not unpacked and objects < count):
        sizes = f"{unpacked - lacking} of {unpacked} bytes (unpacked) and " if unpacked else ""
        missing = f"the file has {sizes}{objects} of {count} objects: some are missing"
        raise damaged(path, missing, "as much as the header states")
    if content.unfinished.strip(b"\0"):
        raise damaged(
            path, f"the last object is not complete, after {objects} whole ones", "whole objects"
        )
    note = (
        f"the header counts {count} objects, the file has {objects}: all sizes agree, "
        "so none is missing (writers differ in what they count)"
    )
    return sum(content.kinds[kind] for kind in _FRAMES), (note,) if objects != count else ()


@dataclass
class _Content:
    """Objects by type, ``unpacked`` bytes of all, ``padding`` after them, and an unfinished one."""

    kinds: Counter[int] = field(default_factory=Counter)
    unpacked: int = 0
    padding: int = 0
    unfinished: bytes = b""


def _walk(file: BinaryIO, end: int, path: Path) -> _Content:
    """All objects from the position of ``file`` to its ``end``, also those in containers."""
    total = _Content()
    while (head := file.read(_OBJECT.size)).strip(b"\0"):
        whole = len(head) == _OBJECT.size and head[:4] == b"LOBJ"
        size, kind = _OBJECT.unpack(head)[3:] if whole else (0, 0)
        if not whole or size - _OBJECT.size > end - file.tell():
            raise damaged(path, f"damaged near byte {file.tell()}", "an object")
        content = file.read(max(size - _OBJECT.size, 0))
        file.read(size % 4)
        total.unpacked += _OBJECT.size
        total.padding += len(content) % 4
        if kind == _CONTAINER:
            total.unpacked += _CONTENT.size
            content = _inflated(content, path)
            total.unfinished = _count(total.unfinished + content, total.kinds, path)
        else:
            total.kinds[kind] += 1
        total.unpacked += len(content)
    return total


def _inflated(content: bytes, path: Path) -> bytes:
    if len(content) < _CONTENT.size:
        raise _bad_container(path, "it has no header")
    method, size = _CONTENT.unpack_from(content)
    packed, whole = content[_CONTENT.size :], True
    if method == _DEFLATE:
        stream = zlib.decompressobj()
        try:
            packed = stream.decompress(packed, _MOST_UNPACKED)
        except zlib.error as cause:
            raise _bad_container(path, str(cause)) from cause
        whole = stream.eof
    if not whole or len(packed) < size:
        raise _bad_container(path, f"it holds {len(packed)} of {size} bytes")
    return packed


def _count(data: bytes, kinds: Counter[int], path: Path) -> bytes:
    """Count the complete objects; returns the bytes of one that is not complete yet."""
    place = 0
    while True:
        start = data.find(b"LOBJ", place, place + _NEXT)
        if start < 0 and len(data) - place > _NEXT:
            raise _bad_container(path, f"no object after {kinds.total()} whole ones")
        if start < 0 or start + _OBJECT.size > len(data):
            return data[place:]
        size, kind = _OBJECT.unpack_from(data, start)[3:]
        if size < _OBJECT.size:
            raise _bad_container(path, f"an object of {size} bytes")
        if start + size > len(data):
            return data[place:]
        kinds[kind] += 1
        place = start + size


def _bad_container(path: Path, why: str) -> LogError:
    return damaged(path, f"a container cannot be unpacked: {why}", "whole containers")

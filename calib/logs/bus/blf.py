"""Read Vector BLF with python-can.

header     LOGG, its length, size of the file, unpacked size, number of objects, start and stop
object     LOBJ, its size, its type, content
container  an object of type 10: method of compression, unpacked size, other objects

python-can does not notice that a file is cut off. So the sizes are compared with the content
first. The number of objects is not compared, since programs that write BLF count differently.
"""

import struct
import zlib
from collections.abc import Iterator
from itertools import islice
from pathlib import Path
from typing import BinaryIO

from calib.base.errors import LogError
from calib.base.extras import need
from calib.logs.bus.recording import capture_of, recording_of, require_dbc
from calib.logs.channel_map import Databases
from calib.logs.source import Recording, damaged

_HEADER = struct.Struct("<4sL8xQQ40x")
_OBJECT = struct.Struct("<4s4xLL")
_CONTAINER = struct.Struct("<H6xL4x")
_CONTAINER_TYPE, _STORED, _DEFLATED = 10, 0, 2  # a type of object; methods of compression
_MOST_UNPACKED = 64_000_000  # bytes of one container; those of Vector have 128 kB


def open_blf(path: Path, dbc: Databases) -> Recording:
    """Open a BLF file. Raises LogError for one that is damaged or not whole, and without a DBC."""
    where = str(path)
    can = need("can", "can", where, LogError)
    database = require_dbc(dbc, "can", where)
    most_frames = _check_sizes(path) // _OBJECT.size  # one of size 0 python-can would read for ever
    with path.open("rb") as file, can.BLFReader(file) as reader:
        capture = capture_of(islice(reader, most_frames + 1), database, where)
    if len(capture.times) > most_frames:
        raise damaged(where, "it has more frames than its size allows")
    return recording_of(capture, database, (), where)


def _check_sizes(path: Path) -> int:
    """Return the unpacked size [bytes]. Raises LogError if the content has not the stated sizes."""
    with path.open("rb") as file:
        head = file.read(_HEADER.size)
        if len(head) < _HEADER.size or head[:4] != b"LOGG":
            raise LogError("not a BLF file", where=path, expected="a file that begins with LOGG")
        _, first, stated, unpacked = _HEADER.unpack(head)
        if not (stated and unpacked):
            flaw = "the recorder did not finish the file: its header has no sizes"
            expected = "sizes to compare with the content"
            do = "open it with the tool that wrote it and save it again"
            raise LogError(flaw, where=path, expected=expected, do=do)
        size = file.seek(0, 2)
        if size < stated:
            share = f"{100 * (1 - size / stated):.0f} % of the file"
            missing = f"{size} of {stated} bytes: {stated - size} are missing ({share})"
            raise damaged(path, f"the file has {missing}", "as much as the header states")
        file.seek(first)
        content: int = first + sum(_object_sizes(file, size, path))
    if content < unpacked:
        missing = f"it unpacks to {content} of {unpacked} bytes: some objects are missing"
        raise damaged(path, missing, "as much as the header states")
    return content


def _object_sizes(file: BinaryIO, end: int, path: Path) -> Iterator[int]:
    """Yield the unpacked size [bytes] of each object up to byte ``end``, padding included."""
    while True:
        head = file.read(_OBJECT.size)
        if not head.strip(b"\0"):  # the end of the file, or zeros up to it
            return
        if len(head) < _OBJECT.size or head[:4] != b"LOBJ":
            raise damaged(path, f"damaged near byte {file.tell()}", "an object")
        _, size, kind = _OBJECT.unpack(head)
        if not _OBJECT.size <= size <= _OBJECT.size + end - file.tell():
            raise damaged(path, f"damaged near byte {file.tell()}", "an object")
        content = file.read(size - _OBJECT.size)
        padding = size % 4  # as Vector and python-can have it, not up to a multiple of 4
        file.read(padding)
        if kind == _CONTAINER_TYPE:
            yield _OBJECT.size + _CONTAINER.size + _unpacked_size(content, path) + padding
        else:
            yield size + padding


def _unpacked_size(container: bytes, path: Path) -> int:
    """Unpack a container and return its size [bytes]. Raises LogError for a damaged one."""
    if len(container) < _CONTAINER.size:
        raise _bad_container(path, "it has no header")
    method, size = _CONTAINER.unpack_from(container)
    content, is_complete = container[_CONTAINER.size :], True
    if method == _DEFLATED:
        stream = zlib.decompressobj()
        try:
            content = stream.decompress(content, _MOST_UNPACKED)
        except zlib.error as cause:
            raise _bad_container(path, str(cause)) from cause
        is_complete = stream.eof
    elif method != _STORED:
        raise _bad_container(path, f"its method of compression, {method}, is not known")
    if not is_complete or len(content) < size:
        raise _bad_container(path, f"it holds {len(content)} of {size} bytes")
    return len(content)


def _bad_container(path: Path, flaw: str) -> LogError:
    return damaged(path, f"a container cannot be unpacked: {flaw}", "whole containers")

"""BLF files byte by byte, laid out as Vector's writers do; the layout is that of public files.

header 144 bytes | container | container | ...      a container is padded by its size modulo 4
"""

import struct
import zlib
from collections.abc import Iterable, Sequence

HEADER = 144
RESTORE = 115
"""Type of the objects that Vector's writers append and do not count."""


def frame(time: float, identifier: int, data: bytes, channel: int = 1) -> bytes:
    """A classic frame (type 1) at a time [s]."""
    body = struct.pack("<HBBL8s", channel, 0, len(data), identifier, data)
    return block(1, struct.pack("<LHHQ", 2, 0, 0, round(time * 1e9)) + body)


def block(kind: int, content: bytes, size: int | None = None) -> bytes:
    """An object; ``size`` replaces its true size."""
    return struct.pack("<4sHHLL", b"LOBJ", 32, 1, size or 16 + len(content), kind) + content


def container(content: bytes, compressed: bool = False, declared: int | None = None) -> bytes:
    """A container; ``declared`` replaces the size of its content."""
    packed = zlib.compress(content) if compressed else content
    head = struct.pack(
        "<H6xL4x", 2 if compressed else 0, len(content) if declared is None else declared
    )
    container_bytes = block(10, head + packed)
    return container_bytes + bytes(len(container_bytes) % 4)


def blf(
    parts: Sequence[bytes], count: int, compressed: bool = False, unpacked: int | None = None
) -> bytes:
    """A file with a container for each of ``parts``; ``unpacked`` replaces its unpacked size."""
    body = b"".join(container(part, compressed) for part in parts)
    return header(len(body), parts, count, unpacked) + body


def header(body: int, parts: Iterable[bytes], count: int, unpacked: int | None = None) -> bytes:
    """The header of a file whose containers have ``body`` bytes in all."""
    if unpacked is None:
        unpacked = HEADER + sum(32 + len(part) for part in parts)
    day = struct.pack("<8H", 2023, 11, 2, 14, 22, 13, 20, 0)
    head = struct.pack("<4sLL4xQQLL", b"LOGG", HEADER, 4080000, HEADER + body, unpacked, count, 0)
    return (head + day + day).ljust(HEADER, b"\0")

"""Check that an MDF 4 file holds as many records as its groups count.

##DG --> ##CG count, bytes of a record      needed: the sum over the groups of count times bytes
     --> ##HL --> ##DL --> ##DT, ##DZ       present: the sum of their lengths, unpacked
"""

import struct
from pathlib import Path
from typing import BinaryIO

from calib.errors import LogError
from calib.files.bounded import RECORDING

_BLOCK = struct.Struct("<4s4xQQ")
_COUNT = struct.Struct("<8xQHHLLL")
_UNPACKED = struct.Struct("<8xQ")
_VARIABLE = 1
"""Flag of a group whose records differ in length; such a group has no channels."""


def check_records(path: Path) -> None:
    """Raise LogError if a data group has less data than its records need.

    The file must have all its blocks (`calib.logs.mdf.size`). Data that is not a list of blocks is
    not checked here; the reader compares the number of its samples with the count.
    """
    try:
        _check(path)
    except (struct.error, IndexError, ValueError, OverflowError) as cause:
        raise LogError(
            "its groups are not as MDF 4 has them", where=path, do="copy the log again"
        ) from cause


def _check(path: Path) -> None:
    with path.open("rb") as file:
        (place, *_), _ = _block(file, 64)
        number, most = 0, RECORDING.most
        seen = set[int]()
        while place:
            _once(place, seen)
            (place, group, data, *_), content = _block(file, place)
            needed = _needed(file, group, content[0], seen)
            there = _there(file, data) if data else 0
            if max(needed, there or 0) > most:
                raise LogError(
                    RECORDING.excess(max(needed, there or 0), f"data group {number} unpacks to"),
                    where=path,
                    do=RECORDING.advice,
                )
            if there is not None and there < needed:
                raise LogError(
                    f"data group {number} holds {there} of {needed} bytes of samples: "
                    f"{needed - there} are missing ({100 * (1 - there / needed):.0f} %)",
                    where=path,
                    expected="as many samples as it counts",
                    do="copy the log again",
                )
            number += 1


def _once(place: int, seen: set[int]) -> None:
    """Raise ValueError for a block that was met before: links in a ring have no end."""
    if place in seen:
        raise ValueError(f"a ring of links at byte {place}")
    seen.add(place)


def _block(file: BinaryIO, place: int) -> tuple[tuple[int, ...], bytes]:
    """Links of a block, and the first bytes of its content."""
    file.seek(place)
    _, length, links = _BLOCK.unpack(file.read(_BLOCK.size))
    read = file.read(8 * links + min(64, length - _BLOCK.size - 8 * links))
    return struct.unpack_from(f"<{links}Q", read), read[8 * links :]


def _needed(file: BinaryIO, place: int, id_size: int, seen: set[int]) -> int:
    total = 0
    while place:
        _once(place, seen)
        (place, channels, *_), content = _block(file, place)
        count, flags, _, _, size, invalid = _COUNT.unpack_from(content)
        if channels or not flags & _VARIABLE:
            total += count * (size + invalid + id_size)
    return total


def _there(file: BinaryIO, place: int) -> int | None:
    """Bytes of data at a link; None if it is not a list of data blocks."""
    total, todo = 0, [place]
    seen = set[int]()
    while todo:
        place = todo.pop()
        if not place:
            continue
        _once(place, seen)
        file.seek(place)
        kind, length, _ = _BLOCK.unpack(file.read(_BLOCK.size))
        if kind in (b"##HL", b"##DL"):
            todo += _block(file, place)[0]
        elif kind == b"##DT":
            total += length - _BLOCK.size
        elif kind == b"##DZ":
            total += _UNPACKED.unpack_from(_block(file, place)[1])[0]
        else:
            return None
    return total

"""Finish an MDF 4 file in memory that its recorder left unfinished, as CAN loggers always do.

identification   UnFinMF, flags 0x25: counts, length of the last DT, sizes of the VLSD groups
##DG --> ##CG    count 0                              set to the records that are there
     --> ##DT    length 24, records up to the end     set to the end of the last whole record

The record of a group is: identifier, bytes; that of a VLSD group: identifier, length, bytes.
Source: ASAM MDF 4.1, sections on the identification block and on unfinalised files.
"""

import io
import struct
from dataclasses import dataclass
from pathlib import Path

from calib.errors import LogError
from calib.logs.mdf.blocks import Block, block_at, chain, places, whole_blocks

_FLAGS = struct.Struct("<H")
_FLAGS_AT, _FINISHED = 60, b"MDF     "
_LAST_LENGTH = 4
_FINISHABLE = 1 | _LAST_LENGTH | 32
"""Flags of what is finished here: counts of groups, length of the last DT, sizes of VLSD groups."""
_GROUP = struct.Struct("<QQHHLLL")
_HEAD, _FIRST = 24, 64
_VARIABLE = 1


@dataclass
class _Group:
    """A channel group: position of its content, bytes of a record, and what was found of it.

    ``width`` is -1 if the records differ in length; ``size`` counts their bytes.
    """

    place: int
    width: int
    stated: int
    count: int = 0
    size: int = 0


def finishable(identification: bytes) -> bool:
    """Whether the identification block asks for nothing that `finished` does not do."""
    version = identification[8:12].strip(b" \0")
    if len(identification) < _FIRST or not b"4.10" <= version < b"5":
        return False
    (flags,) = _FLAGS.unpack_from(identification, _FLAGS_AT)
    return bool(flags) and not flags & ~_FINISHABLE


def is_unfinished(path: Path) -> bool:
    """Whether the file says that its recorder did not finish it."""
    with path.open("rb") as file:
        return file.read(8).rstrip(b" \0") == b"UnFinMF"


def finished(path: Path) -> tuple[io.BytesIO, str]:
    """The finished file in memory, and a note. The file itself is not changed.

    `calib.logs.mdf.size.check_size` must have accepted the file. Nothing in it shows whether data
    is missing at its end: the note says so. Raises LogError for data in lists of blocks, for fewer
    records than a group counts, and for damage.
    """
    data = bytearray(path.read_bytes())
    with whole_blocks(path):
        records, left = _finish(data, path)
    part = f"; {left} bytes of a last record that is not whole were left out" if left else ""
    return io.BytesIO(data), (
        f"the recorder did not finish the file: its {records} records were counted here{part}; "
        "nothing in the file shows whether more are missing at its end"
    )


def _finish(data: bytearray, path: Path) -> tuple[int, int]:
    """Set lengths, counts and flags; number of records, and bytes of records not whole."""
    (flags,) = _FLAGS.unpack_from(data, _FLAGS_AT)
    starts = sorted(places(data))
    records = left = 0
    for place in chain(data, block_at(data, _FIRST).links[0]):
        group = block_at(data, place)
        if group.links[2]:
            following = (start for start in starts if start > group.links[2])
            end = next(following, len(data)) if flags & _LAST_LENGTH else 0
            more, unused = _finish_group(data, group, end, path)
            records, left = records + more, left + unused
    data[:8] = _FINISHED
    _FLAGS.pack_into(data, _FLAGS_AT, 0)
    return records, left


def _finish_group(data: bytearray, group: Block, end: int, path: Path) -> tuple[int, int]:
    """Set length and counts of a data group; number of records, and bytes of one not whole.

    ``end`` is 0 if the length of the data is final.
    """
    place = group.links[2]
    block = block_at(data, place)
    if block.kind != b"##DT":
        raise _unfinished(path, f"data in {block.kind.decode(errors='replace')}")
    id_size = data[group.content]
    groups = _groups(data, group.links[1])
    if id_size not in (0, 1, 2, 4, 8) or (not id_size and len(groups) != 1):
        raise _unfinished(path, f"{len(groups)} groups, identifiers of {id_size} bytes")
    begin, end = place + _HEAD, end or place + block.length
    last = _count(data, groups, begin, end, id_size, path)
    left = 0 if not any(data[last:end]) else end - last
    struct.pack_into("<Q", data, place + 8, last - place)
    for item in groups.values():
        _write(data, item, path)
    return sum(item.count for item in groups.values() if item.width >= 0), left


def _groups(data: bytearray, place: int) -> dict[int, _Group]:
    """The channel groups of a data group by record identifier."""
    groups = {}
    for start in chain(data, place):
        content = block_at(data, start).content
        number, count, flags, _, _, size, invalid = _GROUP.unpack_from(data, content)
        width = -1 if flags & _VARIABLE else size + invalid
        groups[number] = _Group(content, width, count)
    return groups


def _count(
    data: bytearray, groups: dict[int, _Group], begin: int, end: int, id_size: int, path: Path
) -> int:
    """Count the records of each group. Returns the end of the last whole record."""
    if not id_size:
        (only,) = groups.values()
        if only.width <= 0:
            raise _unfinished(path, f"records of {only.width} bytes")
        only.count = (end - begin) // only.width
        return begin + only.count * only.width
    place = begin
    while place + id_size <= end:
        number = int.from_bytes(data[place : place + id_size], "little")
        item = groups.get(number)
        if item is None:
            if not any(data[place:end]):  # the recorder reserved space
                break
            raise _damaged(path, place, number)
        start, width = place + id_size, item.width
        if width < 0:
            width, start = int.from_bytes(data[start : start + 4], "little"), start + 4
        if start + width > end:
            break
        item.count, item.size = item.count + 1, item.size + width
        place = start + width
    return place


def _write(data: bytearray, item: _Group, path: Path) -> None:
    """Write the count of a group. Raises LogError if the file counted more records."""
    if item.count < item.stated:
        raise LogError(
            f"{item.count} of {item.stated} records are there: "
            f"{item.stated - item.count} are missing",
            where=path,
            expected="all that the group counts",
            do="copy the log again",
        )
    struct.pack_into("<Q", data, item.place + 8, item.count)
    if item.width < 0:
        struct.pack_into("<Q", data, item.place + 24, item.size)


def _unfinished(path: Path, why: str) -> LogError:
    return LogError(
        f"the recorder did not finish the file (UnFinMF), and it cannot be finished here: {why}",
        where=path,
        expected="one data block for each group",
        do="finish it with the recorder's own tool, or open and save it with an MDF editor",
    )


def _damaged(path: Path, place: int, number: int) -> LogError:
    return LogError(
        f"damaged near byte {place}: no group has records with the identifier {number}",
        where=path,
        expected="records of the groups of the file",
        do="copy the log again",
    )

"""Check an MDF file before asammdf reads it.

asammdf would follow rings of links for ever, and let a damaged file fill the memory.

After an identification block, MDF 4 consists of blocks with links to others; XX is the kind:
##XX  4 bytes unused  length  number of links  links  content
##DG --> ##CG --> ##CN                    ##CG: number of records, bytes of one; ##CN: a channel
     --> ##HL --> ##DL --> ##DT, ##DZ     the records of the groups; ##DZ are compressed

CAN loggers leave MDF 4 unfinished: the last ##DT reaches to the end of the file, and every group
says that it has no records. So the records are counted here. If several groups share a ##DT, a
record is an identifier and its bytes; in a group of variable length (VLSD) it is an identifier, a
length and its bytes.
Source: ASAM MDF 4.1, sections on the identification block and on unfinalised files.
"""

import mmap
import struct
from bisect import bisect
from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from calib.base.bounded import RECORDING
from calib.base.errors import LogError
from calib.logs.source import damaged

_NO_COUNTS, _NO_LAST_LENGTH, _NO_VLSD_SIZES = 1, 4, 32
"""Flags of what a recorder did not write: counts of records, length of the last DT, VLSD sizes."""
_HEAD = 64  # bytes of the identification block, after which the first block begins
_BLOCK = struct.Struct("<4s4xQQ")  # kind, length, number of links
_GROUP = struct.Struct("<QQHHLLL")  # content of ##CG: see `_count_records`
_UNPACKED = struct.Struct("<8xQ")  # content of ##DZ: unpacked size
_MOST_LINKS = 10_000_000
_TREE = (b"##HD", b"##DG", b"##CG", b"##CN")
"""Blocks that form a tree by the first two links of each: in the whole file at most one such link
may lead to any of these blocks, since a second one makes a ring."""
_TREE_LINKS_3 = {b"HD": 1, b"DG": 2, b"CG": 2, b"CN": 1}  # number of such links in MDF 3
_START = 24  # bytes of a ##DT before its data
_VARIABLE = 1  # flag of a group whose records differ in length; such a group has no channels


class _Block(NamedTuple):
    kind: bytes
    length: int  # [bytes]
    links: tuple[int, ...]  # first byte of each block that it links to; 0 for none
    content: int  # first byte of the content


@dataclass
class _Group:
    """A channel group and its records."""

    place: int  # first byte of the group
    stated: int  # number of records that the file states
    size: int  # bytes of a record, unless `is_variable`
    is_variable: bool
    count: int = 0  # number of records that the file holds


def check_mdf(path: Path) -> tuple[str, dict[int, int]]:
    """Check all blocks of a file, and count the records of an unfinished file.

    Return a note, and the number of records by first byte of the group; both are empty for a
    finished file. Raises LogError for a file that is not MDF, is cut off or damaged, or cannot be
    finished.
    """
    with path.open("rb") as file:
        head = file.read(_HEAD)
        begin, version = head[:8].rstrip(b" \0"), head[8:12].strip(b" \0")
        if begin not in (b"MDF", b"UnFinMF"):
            raise LogError("not an MDF file", where=path, expected="a file that begins with MDF")
        if len(head) < _HEAD:
            raise _short(path, len(head), _HEAD)
        flags = 0  # of what is missing in an unfinished file
        if begin == b"UnFinMF":
            flags = int.from_bytes(head[60:62], "little")
            unknown = flags & ~(_NO_COUNTS | _NO_LAST_LENGTH | _NO_VLSD_SIZES)
            # without flags it is not known what the recorder did not write
            can_be_finished = flags > 0 and not unknown and b"4.10" <= version < b"5"
            _require(can_be_finished, path, f"flags {flags} of MDF {version!r}")
        if version[:1] not in (b"2", b"3", b"4"):
            text = version.decode(errors="replace")
            raise LogError(f"MDF version {text!r}", where=path, expected="3.x or 4.x")
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data:
            try:
                if version.startswith(b"4"):
                    starts = sorted([*_check_blocks(data, path), len(data)])
                    return _count_records(data, flags, starts, path) if flags else ("", {})
                byte_order = "<" if head[24:26] == b"\0\0" else ">"
                _refuse_rings(data, byte_order, path)
                return "", {}
            except (struct.error, IndexError, ValueError, OverflowError) as cause:
                flaw = f"a block is shorter than its kind, or links go round: {cause}"
                raise damaged(path, flaw) from cause


def _block_at(data: mmap.mmap, place: int) -> _Block:
    kind, length, links = _BLOCK.unpack_from(data, place)
    begin = place + _BLOCK.size
    return _Block(kind, length, struct.unpack_from(f"<{links}Q", data, begin), begin + 8 * links)


def _chain(data: mmap.mmap, place: int, kind: bytes) -> Iterator[tuple[int, _Block]]:
    """Yield the first byte and the block for each block of a chain, which the first links form."""
    while place:
        block = _block_at(data, place)
        if block.kind != kind:
            raise ValueError(f"no {kind!r} at byte {place}")
        yield place, block
        place = block.links[0]


def _refuse_rings(data: mmap.mmap, byte_order: str, path: Path) -> None:
    """Raise ValueError for two links of MDF 3 to one block, LogError for a link past the end."""
    visited, todo = set[int](), [_HEAD]
    while todo:
        place = todo.pop()
        if place in visited:
            raise ValueError(f"a second link to byte {place}")
        visited.add(place)
        end = place + 4
        if end <= len(data):
            end = place + struct.unpack_from(f"{byte_order}H", data, place + 2)[0]
        if end > len(data):
            raise _short(path, len(data), end)
        links = _TREE_LINKS_3.get(data[place : place + 2], 0)
        todo += filter(None, struct.unpack_from(f"{byte_order}{links}I", data, place + 4))


def _check_blocks(data: mmap.mmap, path: Path) -> set[int]:
    """Return the first bytes of all blocks of MDF 4. Raises for a block past the end, or a ring."""
    visited, linked, todo = set[int](), set[int](), [_HEAD]
    size, end, unpacked = len(data), _HEAD, 0  # bytes of the file, of its blocks, of all ##DZ
    while todo:
        place = todo.pop()
        if place in visited or place == 0:
            continue
        visited.add(place)
        end = max(end, place + _BLOCK.size)
        if place + _BLOCK.size > size:  # cut off: go on, to add up how much is missing
            continue
        kind, length, links = _BLOCK.unpack_from(data, place)
        if kind[:2] != b"##" or links > _MOST_LINKS or length < _BLOCK.size + 8 * links:
            raise damaged(path, f"there should be a block at byte {place}, but there is none")
        end = max(end, place + length)
        if kind == b"##DZ" and end <= size:
            unpacked += _UNPACKED.unpack_from(data, place + _BLOCK.size)[0]
        if links and place + _BLOCK.size + 8 * links <= size:
            targets = struct.unpack_from(f"<{links}Q", data, place + _BLOCK.size)
            todo += targets
            for link in targets[:2]:
                if kind in _TREE and data[link : link + 4] in _TREE:
                    if link in linked:
                        raise ValueError(f"a second link to byte {link}")
                    linked.add(link)
    if end > size:
        raise _short(path, size, end)
    if unpacked > RECORDING.max_bytes:
        raise LogError(RECORDING.size_message("its data unpacks to"), where=path)
    return visited


def _count_records(
    data: mmap.mmap, flags: int, starts: list[int], path: Path
) -> tuple[str, dict[int, int]]:
    """Count the records of an unfinished file; return a note and the counts by group.

    ``starts`` are the first bytes of the blocks and the size of the file, ascending. asammdf would
    stop counting without an error at a record with an unknown identifier.
    """
    counts: dict[int, int] = {}
    records = leftover = 0
    for _, data_group in _chain(data, _block_at(data, _HEAD).links[0], b"##DG"):
        groups: dict[int, _Group] = {}
        for place, block in _chain(data, data_group.links[1], b"##CG"):
            # a record has ``size`` bytes of values, then ``invalid`` bytes that mark invalid values
            number, stated, kind, _, _, size, invalid = _GROUP.unpack_from(data, block.content)
            _require(number not in groups, path, f"two groups with the identifier {number}")
            groups[number] = _Group(place, stated, size + invalid, bool(kind & _VARIABLE))
        begin, id_size = data_group.links[2], data[data_group.content]
        if not begin:
            continue
        block = _block_at(data, begin)
        _require(block.kind == b"##DT", path, f"data in {block.kind!r}")
        is_readable = id_size in (1, 2, 4, 8) or (id_size == 0 and len(groups) == 1)
        _require(is_readable, path, f"{len(groups)} groups, identifiers of {id_size} bytes")
        end = begin + block.length
        if flags & _NO_LAST_LENGTH:  # records reach to the next block, or to the end of the file
            end = starts[bisect(starts, begin)]
        last = _count_in(data, (begin + _START, end), groups, id_size, path)
        if any(data[last:end]):
            leftover += end - last
        for group in groups.values():
            if group.count < group.stated:
                missing = f"{group.stated - group.count} are missing"
                flaw = f"{group.count} of {group.stated} records are there: {missing}"
                raise damaged(path, flaw, "all that the group counts")
            if not group.is_variable:
                counts[group.place] = group.count if flags & _NO_COUNTS else group.stated
                records += group.count
    note = f"the recorder did not finish the file: its {records} records were counted here"
    if leftover:
        note += f"; {leftover} bytes of a last record that is not whole were left out"
    return f"{note}; nothing in the file shows whether more are missing at its end", counts


def _count_in(
    data: mmap.mmap, span: tuple[int, int], groups: dict[int, _Group], id_size: int, path: Path
) -> int:
    """Count the records within a ``span`` of bytes in their groups; return the end of the last.

    Records begin with an identifier of ``id_size`` bytes, which is 0 if there is one group only.
    """
    place, end = span
    if not id_size:
        (only,) = groups.values()
        _require(not only.is_variable and only.size > 0, path, "records of no fixed size")
        only.count = (end - place) // only.size
        return place + only.count * only.size
    while place + id_size <= end:
        number = int.from_bytes(data[place : place + id_size], "little")
        group = groups.get(number)
        if group is None:
            if not any(data[place:end]):  # zeros in space that the recorder reserved
                break
            flaw = f"damaged near byte {place}: no group has records with the identifier {number}"
            raise damaged(path, flaw, "records of the groups of the file")
        start, size = place + id_size, group.size
        if group.is_variable:  # the length of the record comes first
            size = 4 + int.from_bytes(data[start : start + 4], "little")
        if start + size > end:
            break
        group.count += 1
        place = start + size
    return place


def _short(path: Path, size: int, end: int) -> LogError:
    missing = f"{end - size} are missing ({100 * (1 - size / end):.0f} % of the file)"
    flaw = f"cut off: the file has {size} bytes, its blocks need {end}; at least {missing}"
    return damaged(path, flaw, "a complete file")


def _require(condition: bool, path: Path, why: str) -> None:
    """Raise LogError, because an unfinished file cannot be finished, unless a condition is met."""
    if not condition:
        flaw = f"the recorder did not finish the file, and it cannot be finished here: {why}"
        expected = "MDF 4.1 that lacks only counts and the length of its data"
        do = "finish it with the recorder's own tool, or open and save it with an MDF editor"
        raise LogError(flaw, where=path, expected=expected, do=do)

"""Check an MDF file before asammdf reads it, which asks little: channels within their records, and
as many records as the groups count.

##DG --> ##CG --> ##CN                count, bytes of a record; the bits of a channel within it
     --> ##HL --> ##DL --> ##DT, ##DZ     present: the sum of their lengths, unpacked

CAN loggers leave MDF 4 unfinished: the last ##DT goes up to the end, and no group counts. The
record of a group is then identifier, bytes; that of a VLSD group identifier, length, bytes.
Source: ASAM MDF 4.1, sections on the identification block and on unfinalised files.
"""

import mmap
import struct
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path

from calib.base.bounded import RECORDING
from calib.base.errors import LogError
from calib.logs.mdf_blocks import (
    COUNTS,
    HEAD,
    LAST_LENGTH,
    Block,
    block_at,
    chain,
    check_3,
    check_4,
    identification,
    not_finished,
    refuse_again,
    whole_blocks,
)
from calib.logs.source import damaged

_GROUP = struct.Struct("<QQHHLLL")
_CHANNEL = struct.Struct("<3xBLL")
_UNPACKED = struct.Struct("<8xQ")
_START = 24
"""Bytes of a ##DT before its data."""
_VARIABLE = 1
"""Flag of a group whose records differ in length; such a group has no channels."""


@dataclass(frozen=True)
class Checked:
    """The version of a file that may be read; an unfinished one has a ``note`` and ``counts``.

    ``counts`` are the records that are there, by the first byte of their channel group.
    """

    version: str
    note: str = ""
    counts: dict[int, int] = field(default_factory=dict)


@dataclass
class _Group:
    """A channel group: its first byte, first channel and number; records stated and found.

    ``size`` bytes of a record; ``variable`` if they differ in length.
    """

    place: int
    channels: int
    number: int
    stated: int
    size: int
    variable: bool
    count: int = 0


def check_mdf(path: Path) -> Checked:
    """Compare a file with its links, record sizes and record counts.

    Raises LogError for a file that is not MDF, too short (with the number of missing bytes) or
    damaged, that has a channel of MDF 4 outside its record or fewer records than a group counts,
    and for one that its recorder did not finish in a way that asammdf cannot.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        found = identification(file, size, path)
        if not found.version.startswith("4"):
            check_3(file, found.little_endian, size, path)
            return Checked(found.version)
        with mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data, whole_blocks(path):
            starts = check_4(data, path)
            _check_channels(data, path)
            if found.flags:
                return _counted(data, found.flags, sorted(starts), found.version, path)
            _check_records(data, path)
            return Checked(found.version)


def _data_groups(data: mmap.mmap) -> Iterator[tuple[int, int, list[_Group]]]:
    """First byte of the data, bytes of an identifier, and channel groups of each data group."""
    seen = set[int]()
    for _, block in chain(data, block_at(data, HEAD).links[0]):
        groups = []
        for place, group in chain(data, block.links[1]):
            refuse_again(place, seen)
            number, count, flags, _, _, size, invalid = _GROUP.unpack_from(data, group.content)
            variable = bool(flags & _VARIABLE)
            groups.append(_Group(place, group.links[1], number, count, size + invalid, variable))
        yield block.links[2], data[block.content], groups


def _check_channels(data: mmap.mmap, path: Path) -> None:
    """Raise LogError for a channel outside its record: asammdf reads there without looking."""
    for _, _, groups in _data_groups(data):
        for group in groups:
            for place, block in _channels(data, group.channels):
                bit, byte, bits = _CHANNEL.unpack_from(data, block.content)
                if 8 * byte + bit + bits > 8 * group.size:
                    what = f"the channel at byte {place} lies outside the records of its group"
                    raise damaged(path, what, f"bits within {group.size} bytes")


def _channels(data: mmap.mmap, first: int) -> Iterator[tuple[int, Block]]:
    """Channels of a group, and those of which a channel is composed."""
    seen, todo = set[int](), [first]
    while todo:
        for place, block in chain(data, todo.pop()):
            if place in seen or block.kind != b"##CN":
                break
            seen.add(place)
            yield place, block
            todo.append(block.links[1])


def _check_records(data: mmap.mmap, path: Path) -> None:
    """Raise LogError if a data group has less data than its records need."""
    for number, (place, id_size, groups) in enumerate(_data_groups(data)):
        counted = [group for group in groups if group.channels or not group.variable]
        needed = sum(group.stated * (group.size + id_size) for group in counted)
        there = _bytes_of_data(data, place) if place else 0
        if max(needed, there or 0) > RECORDING.most:
            raise LogError(
                RECORDING.excess(max(needed, there or 0), f"data group {number} unpacks to"),
                where=path,
                do=RECORDING.advice,
            )
        if there is not None and there < needed:
            what = (
                f"data group {number} holds {there} of {needed} bytes of samples: "
                f"{needed - there} are missing ({100 * (1 - there / needed):.0f} %)"
            )
            raise damaged(path, what, "as many samples as it counts")


def _bytes_of_data(data: mmap.mmap, place: int) -> int | None:
    """Bytes of data at a link, unpacked; None if it is not a list of data blocks.

    Where it is none the reader compares the number of its samples with the count.
    """
    total, todo, seen = 0, [place], set[int]()
    while todo:
        place = todo.pop()
        if not place:
            continue
        refuse_again(place, seen)
        block = block_at(data, place)
        if block.kind in (b"##HL", b"##DL"):
            todo += block.links
        elif block.kind == b"##DT":
            total += block.length - _START
        elif block.kind == b"##DZ":
            total += _UNPACKED.unpack_from(data, block.content)[0]
        else:
            return None
    return total


def _counted(data: mmap.mmap, flags: int, starts: list[int], version: str, path: Path) -> Checked:
    """Count the records of an unfinished file.

    asammdf counts them, too, but stops without a word where a record has an unknown identifier.
    """
    counts: dict[int, int] = {}
    records = left = 0
    for place, id_size, groups in _data_groups(data):
        if not place:
            continue
        block = block_at(data, place)
        kind = block.kind.decode(errors="replace")
        _require(kind == "##DT", path, f"data in {kind}")
        known = id_size in (1, 2, 4, 8) or (id_size == 0 and len(groups) == 1)
        _require(known, path, f"{len(groups)} groups, identifiers of {id_size} bytes")
        following = (start for start in starts if start > place)
        end = next(following, len(data)) if flags & LAST_LENGTH else place + block.length
        last = _count(data, groups, (place + _START, end), id_size, path)
        left += end - last if any(data[last:end]) else 0
        for group in groups:
            if group.count < group.stated:
                missing = f"{group.stated - group.count} are missing"
                what = f"{group.count} of {group.stated} records are there: {missing}"
                raise damaged(path, what, "all that the group counts")
            if not group.variable:
                counts[group.place] = group.count if flags & COUNTS else group.stated
                records += group.count
    part = f"; {left} bytes of a last record that is not whole were left out" if left else ""
    note = (
        f"the recorder did not finish the file: its {records} records were counted here{part}; "
        "nothing in the file shows whether more are missing at its end"
    )
    return Checked(version, note, counts)


def _count(
    data: mmap.mmap, groups: list[_Group], span: tuple[int, int], id_size: int, path: Path
) -> int:
    place, end = span
    if not id_size:
        (only,) = groups
        _require(not only.variable and only.size > 0, path, "records of no fixed size")
        only.count = (end - place) // only.size
        return place + only.count * only.size
    by_number = {group.number: group for group in groups}
    while place + id_size <= end:
        number = int.from_bytes(data[place : place + id_size], "little")
        group = by_number.get(number)
        if group is None:
            if not any(data[place:end]):  # the recorder reserved space
                break
            what = f"damaged near byte {place}: no group has records with the identifier {number}"
            raise damaged(path, what, "records of the groups of the file")
        start, width = place + id_size, group.size
        if group.variable:
            width, start = int.from_bytes(data[start : start + 4], "little"), start + 4
        if start + width > end:
            break
        group.count += 1
        place = start + width
    return place


def _require(known: bool, path: Path, why: str) -> None:
    if not known:
        raise not_finished(
            path, f"and it cannot be finished here: {why}", "one data block for each group"
        )

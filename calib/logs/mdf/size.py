"""Check that an MDF file is as long as its links and record counts require.

MDF 4   every block has a length and links to others by byte      ##DG -> ##CG -> ##CN ...
MDF 3   a data group links to its data, of length records times record size
"""

import struct
from itertools import pairwise
from pathlib import Path
from typing import BinaryIO

from calib.errors import LogError
from calib.logs.mdf.finish import finishable

_V4 = struct.Struct("<4s4xQQ")
_HEAD, _ID_SIZE = 64, 64
_MOST_LINKS = 10_000_000


def check_size(path: Path) -> str:
    """Compare the size of a file with its blocks, in MDF 3 also with its record counts.

    Returns the version of the format. Raises LogError for a file that is not MDF, that the
    recorder did not finish and that cannot be finished here (`calib.logs.mdf.finish`), or that is
    too short, with the number of missing bytes.
    """
    size = path.stat().st_size
    with path.open("rb") as file:
        identification = file.read(_ID_SIZE)
        _check_identification(identification, size, path)
        version = identification[8:12].strip(b" \0")
        if not version.isascii():
            raise LogError(f"MDF version {version!r}", where=path, expected="3.x or 4.x")
        if version.startswith(b"4"):
            _walk_v4(file, size, path)
        elif version.startswith((b"2", b"3")):
            little = identification[24:26] == b"\0\0"
            _walk_v3(file, "<" if little else ">", size, path)
        else:
            raise LogError(
                f"MDF version {version.decode(errors='replace')!r}",
                where=path,
                expected="3.x or 4.x",
            )
    return version.decode(errors="replace")


def _check_identification(identification: bytes, size: int, path: Path) -> None:
    begin = identification[:8].rstrip(b" \0")
    if begin == b"UnFinMF" and not finishable(identification):
        raise LogError(
            "the recorder did not finish the file (UnFinMF), so its counts are not final",
            where=path,
            expected="a finished file, or one that lacks only counts and the length of its data",
            do="finish it with the recorder's own tool, or open and save it with an MDF editor",
        )
    if begin not in (b"MDF", b"UnFinMF"):
        raise LogError("not an MDF file", where=path, expected="a file that begins with MDF")
    if len(identification) < _ID_SIZE:
        raise _short(size, _HEAD, path)


def _walk_v4(file: BinaryIO, size: int, path: Path) -> None:
    """Follow every link; the file must reach the furthest end of a block."""
    seen, todo, end = set[int](), [_HEAD], _HEAD
    while todo:
        place = todo.pop()
        if place in seen or place == 0:
            continue
        seen.add(place)
        end = max(end, place + _V4.size)
        if place + _V4.size > size:
            continue
        file.seek(place)
        kind, length, links = _V4.unpack(file.read(_V4.size))
        if kind[:2] != b"##" or links > _MOST_LINKS or length < _V4.size + 8 * links:
            raise _no_block("block", place, path)
        end = max(end, place + length)
        if links and place + _V4.size + 8 * links <= size:
            todo += struct.unpack(f"<{links}Q", file.read(8 * links))
    if end > size:
        raise _short(size, end, path)


def _walk_v3(file: BinaryIO, order: str, size: int, path: Path) -> None:
    """Follow groups and channels; the length of the data follows from its records."""
    end = _HEAD

    def block(place: int, kind: bytes, form: str) -> tuple[int, ...]:
        nonlocal end
        layout = struct.Struct(f"{order}2sH{form}")
        end = max(end, place + layout.size)
        if place + layout.size > size:
            raise _short(size, end, path)
        file.seek(place)
        found, length, *rest = layout.unpack(file.read(layout.size))
        if found != kind:
            raise _no_block(f"{kind.decode()} block", place, path)
        end = max(end, place + length)
        return tuple(rest)

    ranges: list[tuple[int, int]] = []

    def refuse_again(place: int) -> None:
        if place in seen:
            raise _no_block("block that was not met before", place, path)
        seen.add(place)

    seen = set[int]()
    (group,) = block(_HEAD, b"HD", "I")
    while group:
        refuse_again(group)
        group, channels, _, data, _, ids = block(group, b"DG", "IIIIHH")
        needed = 0
        while channels:
            refuse_again(channels)
            channels, channel, _, _, _, width, count = block(channels, b"CG", "IIIHHHI")
            needed += count * (width + ids)
            while channel:
                refuse_again(channel)
                channel, *others = block(channel, b"CN", "IIIII")
                end = max([end, *(o + 4 for o in others)])
        ranges += [(data, data + needed)] if data and needed else []
    end = max([end, *(stop for _, stop in ranges)])
    if end > size:
        raise _short(size, end, path)
    ranges.sort()
    for (begin, stop), (following, _) in pairwise(ranges):
        if stop > following > begin:
            raise LogError(
                f"{following - begin} of {stop - begin} bytes of samples come before those of "
                f"another group: {stop - following} are missing",
                where=path,
                expected="as many samples as each group counts",
                do="copy the log again",
            )


def _short(size: int, end: int, path: Path) -> LogError:
    return LogError(
        f"cut off: the file has {size} bytes, its blocks need {end}; at least {end - size} "
        f"are missing ({100 * (1 - size / end):.0f} % of the file)",
        where=path,
        expected="a complete file",
        do="copy the log again",
    )


def _no_block(what: str, place: int, path: Path) -> LogError:
    return LogError(
        f"there should be a {what} at byte {place}, but there is none",
        where=path,
        expected="an undamaged file",
        do="copy the log again",
    )

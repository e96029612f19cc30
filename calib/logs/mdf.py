"""ASAM MDF 3 and 4, read with asammdf: measured channels, and bus frames with a DBC."""

import io
import logging
from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from calib.base.errors import LogError
from calib.logs.bus.dbc import Dbc
from calib.logs.bus.frames import Frames, Known, joined, once
from calib.logs.bus.recording import described, require_dbc, require_known, trace
from calib.logs.channel_map import Databases
from calib.logs.mdf_check import check_mdf
from calib.logs.source import CLOCK, ChannelTrace, Column, Recording, damaged, need

VALUE_TO_TEXT = {"3": (11, 12), "4": (7, 8)}
"""Types of conversion that give text instead of numbers, by version of MDF."""

FRAME = "CAN_DataFrame"
"""Name of the channel for data frames in the ASAM standard."""

TIME_SYNC = 1
"""Type of a master channel of MDF 4 that holds time, not angle or distance."""


@dataclass(frozen=True)
class _Place:
    group: int
    index: int


def open_mdf(path: Path, dbc: Databases) -> Recording:
    """Open an MDF file; its frames are decoded with the DBC, and without one ignored with a note.

    A file that its recorder did not finish is finished in memory, by asammdf, with a note. Raises
    LogError as `check_mdf`, and if asammdf cannot read it.
    """
    where = str(path)
    asammdf = need("asammdf", "mdf", where)
    logging.getLogger("asammdf").setLevel(logging.CRITICAL + 1)  # its errors are raised as LogError
    checked = check_mdf(path)
    try:
        file = io.BytesIO(path.read_bytes()) if checked.note else path
        mdf = asammdf.MDF(file, process_bus_logging=False)
    except Exception as cause:  # a damaged file makes asammdf raise almost anything
        raise _unreadable(cause, where) from cause
    try:
        _check_groups(mdf, checked.counts, where)
        return _recording(mdf, dbc, [checked.note] if checked.note else [], where)
    except BaseException:
        mdf.close()
        raise


def _recording(mdf: Any, dbc: Databases, notes: list[str], where: str) -> Recording:
    buses = _bus_groups(mdf)
    columns, places, more_notes = _channels(mdf, buses)
    notes += more_notes
    known = require_dbc(dbc, "mdf", where) if buses and (dbc.all or not columns) else None
    frames = _frames_in(mdf, buses, known.knows, where) if known else []
    frames, doubled = once(frames)
    if known and not columns:
        require_known(frames, (), known, where)
    if buses and not known:
        notes.append("the log has bus frames, which need a DBC: name it in a channel map")
    database = known or Dbc({}, ())
    notes += doubled
    more, signals = described(frames, database)

    def read(indices: Sequence[int]) -> list[ChannelTrace]:
        own = [places[i - 1] for i in indices if i <= len(places)]
        measured = dict(zip(own, _traces(mdf, own, where), strict=True))
        return [
            measured[places[i - 1]] if i <= len(places) else trace(*signals[i - 1 - len(places)])
            for i in indices
        ]

    return Recording((CLOCK, *columns, *more), read, (*database.notes, *notes), mdf.close)


def _check_groups(mdf: Any, counts: dict[int, int], where: str) -> None:
    """Raise LogError for a channel outside its record, where asammdf reads without looking, and if
    it found fewer records of an unfinished file than were counted.
    """
    for group in mdf.groups:
        record = group.channel_group
        if record.cycles_nr < (counted := counts.get(record.address, 0)):
            raise _too_few("records", record.cycles_nr, counted, where)
        size = record.samples_byte_nr + getattr(record, "invalidation_bytes_nr", 0)
        for channel in group.channels:
            if str(mdf.version) < "4":
                byte, bit = getattr(channel, "additional_byte_offset", 0), channel.start_offset
            else:
                byte, bit = channel.byte_offset, channel.bit_offset
            if 8 * byte + bit + channel.bit_count > 8 * size:
                what = f"the channel at byte {channel.address} lies outside its records"
                raise damaged(where, what, f"bits within {size} bytes")


def _channels(mdf: Any, buses: Sequence[int]) -> tuple[list[Column], list[_Place], list[str]]:
    columns, places, notes = [], [], []
    names = Counter(_group(mdf, i) for i in range(len(mdf.groups)))
    for number, group in enumerate(mdf.groups):
        if number in buses or not (group.channel_group.cycles_nr and group.channels):
            continue
        master = mdf.masters_db.get(number)
        if master is None or getattr(group.channels[master], "sync_type", 1) != TIME_SYNC:
            notes.append(f"group {number} has no clock in seconds and was left out")
            continue
        title = _group(mdf, number)
        title = f"{title}#{number}" if names[title] > 1 else title
        for index, channel in enumerate(group.channels):
            if index != master:
                full = f"{title}.{channel.name}"
                columns.append(Column(channel.name, _unit(channel), full))
                places.append(_Place(number, index))
    return columns, places, notes


def _group(mdf: Any, number: int) -> str:
    group = mdf.groups[number].channel_group
    name = getattr(group, "acq_name", "") or ""
    return name or f"group {number}"


def _clock(mdf: Any, number: int) -> str:
    name, plain = _group(mdf, number), f"group {number}"
    return plain if name == plain else f"{plain} {name!r}"


def _unit(channel: Any) -> str | None:
    conversion = getattr(channel.conversion, "unit", "") if channel.conversion else ""
    return (channel.unit or conversion or "").strip() or None


def _traces(mdf: Any, places: Sequence[_Place], where: str) -> list[ChannelTrace]:
    signals = _select(mdf, places, True, where)
    result = []
    for place, signal in zip(places, signals, strict=True):
        channel = mdf.groups[place.group].channels[place.index]
        name = f"{where}: {channel.name}"
        cycles = int(mdf.groups[place.group].channel_group.cycles_nr)
        read = len(signal.samples)  # a sample may be an array
        if not read == signal.timestamps.size == cycles:
            raise _too_few("samples", read, cycles, name)
        values, state = _values(mdf, place, signal, where)
        result.append(ChannelTrace(_clock(mdf, place.group), signal.timestamps, values, state))
    return result


def _select(mdf: Any, places: Sequence[_Place], numbers: bool, where: str) -> list[Any]:
    wanted = [(None, place.group, place.index) for place in places]
    try:
        signals: list[Any] = mdf.select(
            wanted, copy_master=False, ignore_value2text_conversions=numbers
        )
    except Exception as cause:  # as above
        raise _unreadable(cause, where) from cause
    return signals


def _values(mdf: Any, place: _Place, signal: Any, where: str) -> tuple[np.ndarray, bool]:
    """Numbers, NaN where invalid or replaced by a name, and whether the channel is a state."""
    channel = mdf.groups[place.group].channels[place.index]
    kinds = VALUE_TO_TEXT[str(mdf.version)[0].replace("2", "3")]
    state = bool(channel.conversion) and channel.conversion.conversion_type in kinds
    samples = signal.samples
    if state:
        named_values = _select(mdf, [place], False, where)[0].samples
        if named_values.dtype.kind in "iuf":  # names for some values only, such as "not available"
            samples, state = named_values, False
    if samples.dtype.kind not in "biuf" or samples.ndim != 1:
        raise LogError(
            f"holds {samples.dtype}, shape {samples.shape[1:]}",
            where=f"{where}: {channel.name}",
            expected="a numeric channel",
        )
    values = samples.astype(np.float64)
    invalid = signal.invalidation_bits
    if invalid is not None:
        values[np.asarray(invalid, bool)] = np.nan
    return values, state


def _bus_groups(mdf: Any) -> list[int]:
    return [
        number
        for number, group in enumerate(mdf.groups)
        if any(c.name.startswith(("CAN_", "LIN_")) and "Frame" in c.name for c in group.channels)
    ]


def _frames_in(mdf: Any, groups: list[int], known: Known, where: str) -> list[Frames]:
    found = []
    for number in groups:
        names = {c.name for c in mdf.groups[number].channels}
        if f"{FRAME}.DataBytes" in names and mdf.groups[number].channel_group.cycles_nr:
            found += _frames(mdf, number, known, where)
    return joined(found, lambda item: (item.bus, item.key))


def _frames(mdf: Any, number: int, known: Known, where: str) -> list[Frames]:
    try:
        identifier = mdf.get(f"{FRAME}.ID", group=number)
        others = {k: _field(mdf, number, k) for k in ("IDE", "BusChannel", "DataLength")}
        data = mdf.get(f"{FRAME}.DataBytes", group=number).samples
    except Exception as cause:  # a damaged file makes asammdf raise almost anything
        raise _unreadable(cause, where, "frames") from cause
    ids, time = identifier.samples, identifier.timestamps
    cycles = int(mdf.groups[number].channel_group.cycles_nr)
    if not len(data) == ids.size == cycles:
        raise _too_few("frames", min(len(data), ids.size), cycles, where)
    fields = [ids, *(field for field in others.values() if field is not None)]
    if data.ndim != 2 or any(f.ndim != 1 or f.dtype.kind not in "biuf" for f in fields):
        raise damaged(
            where,
            "the fields of its frames are not numbers",
            "identifier, bus, length and bytes of each frame",
        )
    ids = ids.astype(np.int64)  # loggers store 11 bits of identifier in 16
    bare = ids & 0x1FFFFFFF
    extended = others["IDE"].astype(bool) if others["IDE"] is not None else ids > 0x7FF
    bus = others["BusChannel"] if others["BusChannel"] is not None else np.zeros(ids.size, int)
    length = others["DataLength"]
    if length is None:
        length = np.full(ids.size, data.shape[1])
    if length.max(initial=0) > data.shape[1]:
        raise damaged(
            where,
            f"a frame has a length of {length.max()} bytes, its record {data.shape[1]}",
            "frames within their records",
        )
    codes = bus.astype(np.int64) << 30 | extended.astype(np.int64) << 29 | bare
    result = []
    for code in np.unique(codes).tolist():
        name, key = f"{code >> 30}", (code & 0x1FFFFFFF, bool(code >> 29 & 1))
        if known(name, key):
            at = np.flatnonzero(codes == code)
            part = np.ascontiguousarray(data[at, : int(length[at].max())], np.uint8)
            result.append(Frames(name, key, time[at], part, length[at].astype(np.uint16), at))
    return result


def _field(mdf: Any, number: int, name: str) -> Any:
    names = {c.name for c in mdf.groups[number].channels}
    full = f"{FRAME}.{name}"
    return mdf.get(full, group=number).samples if full in names else None


def _too_few(what: str, there: int, counted: int, where: str) -> LogError:
    return damaged(
        where,
        f"{there} of {counted} {what} can be read: {counted - there} are missing",
        "all that the group counts",
    )


def _unreadable(cause: Exception, where: str, what: str = "file") -> LogError:
    return damaged(
        where,
        f"asammdf cannot read the {what}: {str(cause) or type(cause).__name__}",
        "a complete and undamaged MDF file",
    )

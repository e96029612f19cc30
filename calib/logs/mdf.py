"""Read ASAM MDF 3 and 4 with asammdf: measured channels, and bus frames with a DBC."""

import io
import logging
import re
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from calib.base.bounded import RECORDING
from calib.base.errors import LogError
from calib.base.extras import need
from calib.logs.bus.dbc import Dbc
from calib.logs.bus.recording import Frames, check_described, decode, described_signals, require_dbc
from calib.logs.channel_map import Databases
from calib.logs.mdf_check import check_mdf
from calib.logs.source import CLOCK, ChannelTrace, Column, Recording, damaged

_VALUE_TO_TEXT = {"3": (11, 12), "4": (7, 8)}  # types of conversion to text, by version of MDF
_FRAME = "CAN_DataFrame"  # name of the channel for data frames in the ASAM standard
_BUS_CHANNEL = re.compile(r"(CAN_(Data|Remote|Error|Overload)|LIN_)Frame(\..*)?")
"""Names of channels for bus frames in this standard, and of their fields, such as ``.ID``."""
_TIME_SYNC = 1  # type of a master channel of MDF 4 that holds time, not angle or distance
_Place = tuple[int, int]  # numbers of the group and of the channel in it


def open_mdf(path: Path, dbc: Databases) -> Recording:
    """Open an MDF file. Raises LogError as `check_mdf`, and if asammdf cannot read the file.

    Bus frames are ignored without a DBC, with a note. A file that its recorder did not finish is
    finished in memory by asammdf, with a note.
    """
    where = str(path)
    asammdf = need("asammdf", "mdf", where, LogError)
    logging.getLogger("asammdf").setLevel(logging.CRITICAL + 1)  # its errors are raised as LogError
    note, counts = check_mdf(path)
    is_finished = not note
    with _readable(where):
        file = path if is_finished else io.BytesIO(path.read_bytes())  # asammdf would change it
        mdf = asammdf.MDF(file, process_bus_logging=False)
    try:
        _check_groups(mdf, counts, where)
        return _recording(mdf, dbc, [] if is_finished else [note], where)
    except BaseException:
        mdf.close()
        raise


def _recording(mdf: Any, dbc: Databases, notes: list[str], where: str) -> Recording:
    """Return the measured channels of an open file, and after them the signals of bus frames."""
    bus_groups = [
        number
        for number, group in enumerate(mdf.groups)
        if any(_BUS_CHANNEL.fullmatch(channel.name) for channel in group.channels)
    ]
    titles = _titles(mdf)
    columns, places, left_out = _channels(mdf, bus_groups, titles)
    notes += left_out
    database, frames = Dbc({}), list[Frames]()
    if bus_groups and (any(dbc.values()) or not columns):
        database = require_dbc(dbc, "mdf", where)
        frames = _frames(mdf, bus_groups, database, where)
        if not columns:
            check_described(frames, (), database, where)
    elif bus_groups:
        notes.append("bus frames were not read: CAN needs a DBC in a channel map, LIN is not known")
    signal_columns, signals = described_signals(frames, database)

    def read(indices: Sequence[int]) -> list[ChannelTrace]:
        first_signal = 1 + len(places)  # after the clock and the measured channels
        chosen = [places[i - 1] for i in indices if i < first_signal]
        measured = dict(zip(chosen, _traces(mdf, chosen, titles, where), strict=True))
        return [
            measured[places[i - 1]] if i < first_signal else decode(*signals[i - first_signal])
            for i in indices
        ]

    all_columns, all_notes = (CLOCK, *columns, *signal_columns), (*database.notes, *notes)
    return Recording(all_columns, read, all_notes, mdf.close)


def _check_groups(mdf: Any, counts: dict[int, int], where: str) -> None:
    """Raise LogError for damage that asammdf does not notice, and for a file that is too large.

    A channel must lie within its record. A group of an unfinished file must have as many records as
    were counted: ``counts`` has their number by the first byte of the group.
    """
    for group in mdf.groups:
        record = group.channel_group
        counted = counts.get(record.address, 0)
        if record.cycles_nr < counted:
            raise _too_few("records", record.cycles_nr, counted, where)
        size = record.samples_byte_nr + getattr(record, "invalidation_bytes_nr", 0)
        if record.cycles_nr * size > RECORDING.max_bytes:
            unpacked = f"its records at byte {record.address} unpack to"
            raise LogError(RECORDING.size_message(unpacked), where=where)
        for channel in group.channels:
            if str(mdf.version).startswith("4"):
                byte, bit = channel.byte_offset, channel.bit_offset
            else:
                byte, bit = getattr(channel, "additional_byte_offset", 0), channel.start_offset
            if 8 * byte + bit + channel.bit_count > 8 * size:
                flaw = f"the channel at byte {channel.address} lies outside its records"
                raise damaged(where, flaw, f"bits within {size} bytes")


def _channels(
    mdf: Any, bus_groups: Sequence[int], titles: Sequence[str]
) -> tuple[list[Column], list[_Place], list[str]]:
    """Return columns and places of the measured channels, and notes on groups without a clock."""
    columns, places, notes = [], [], []
    for number, group in enumerate(mdf.groups):
        if number in bus_groups or not (group.channel_group.cycles_nr and group.channels):
            continue
        master = mdf.masters_db.get(number)
        # MDF 3 has masters of time alone, and no `sync_type`
        if master is None or getattr(group.channels[master], "sync_type", _TIME_SYNC) != _TIME_SYNC:
            notes.append(f"group {number} has no clock in seconds and was left out")
            continue
        for index, channel in enumerate(group.channels):
            if index != master:
                written = channel.unit or getattr(channel.conversion, "unit", "") or ""
                unit = written.strip() or None
                columns.append(Column(channel.name, unit, f"{titles[number]}.{channel.name}"))
                places.append((number, index))
    return columns, places, notes


def _titles(mdf: Any) -> list[str]:
    """Return the names of the groups; a name that is not unique gets the number of the group."""
    groups = enumerate(mdf.groups)
    names = [getattr(g.channel_group, "acq_name", "") or f"group {i}" for i, g in groups]
    return [f"{name}#{i}" if names.count(name) > 1 else name for i, name in enumerate(names)]


def _traces(
    mdf: Any, places: Sequence[_Place], titles: Sequence[str], where: str
) -> list[ChannelTrace]:
    result = []
    signals = _select(mdf, places, where, names_as_nan=False)
    for place, signal in zip(places, signals, strict=True):
        number, index = place
        group = mdf.groups[number]
        cycles, channel = int(group.channel_group.cycles_nr), group.channels[index].name
        # a sample may be an array
        if len(signal.samples) != cycles or signal.timestamps.size != cycles:
            readable = min(len(signal.samples), signal.timestamps.size)
            raise _too_few("samples", readable, cycles, f"{where}: {channel}")
        values, is_state = _values(mdf, place, signal, f"{where}: {channel}")
        result.append(ChannelTrace(titles[number], signal.timestamps, values, is_state))
    return result


def _select(mdf: Any, places: Sequence[_Place], where: str, *, names_as_nan: bool) -> list[Any]:
    """Read channels; a value with a name is a number, or, with ``names_as_nan``, NaN or text."""
    with _readable(where):
        signals: list[Any] = mdf.select(
            [(None, *place) for place in places],
            copy_master=False,
            ignore_value2text_conversions=not names_as_nan,
        )
    return signals


def _values(mdf: Any, place: _Place, signal: Any, where: str) -> tuple[np.ndarray, bool]:
    """Return the values (n,) of a channel, and whether it is a state: all its values have names.

    If only some values have names, such as "not available", these become NaN, and so do invalid
    samples.
    """
    conversion = mdf.groups[place[0]].channels[place[1]].conversion
    kinds = _VALUE_TO_TEXT["4" if str(mdf.version).startswith("4") else "3"]
    is_state = bool(conversion) and conversion.conversion_type in kinds
    samples = signal.samples
    if is_state:
        # asammdf returns text if every value has a name, or else numbers, with NaN for named values
        (with_names,) = _select(mdf, [place], where, names_as_nan=True)
        if with_names.samples.dtype.kind in "iuf":
            samples, is_state = with_names.samples, False
    if samples.dtype.kind not in "biuf" or samples.ndim != 1:
        flaw = f"holds {samples.dtype}, shape {samples.shape[1:]}"
        raise LogError(flaw, where=where, expected="a numeric channel")
    values = samples.astype(np.float64)
    if signal.invalidation_bits is not None:
        values[np.asarray(signal.invalidation_bits, bool)] = np.nan
    return values, is_state


def _frames(mdf: Any, groups: list[int], database: Dbc, where: str) -> list[Frames]:
    """Return the frames that the database describes; those of one message from all groups."""
    records = [_frame_records(mdf, number, where) for number in groups]
    parts = [record for record in records if record is not None]
    if not parts:
        return []
    width = max(part.data.shape[1] for part in parts)
    padded = [np.pad(part.data, ((0, 0), (0, width - part.data.shape[1]))) for part in parts]
    data, codes = np.concatenate(padded), np.concatenate([part.codes for part in parts])
    time = np.concatenate([part.time for part in parts])
    length = np.concatenate([part.length for part in parts])
    result = []
    for code in np.unique(codes).tolist():
        bus, key = f"{code >> 30}", (code & 0x1FFFFFFF, bool(code >> 29 & 1))  # as `_FrameRecords`
        if database.find(bus, key):
            rows = np.flatnonzero(codes == code)
            if len(parts) > 1:
                rows = rows[np.argsort(time[rows], kind="stable")]
            frames = np.ascontiguousarray(data[rows, : int(length[rows].max())], np.uint8)
            result.append(Frames(bus, key, time[rows], frames, length[rows].astype(np.uint16)))
    return result


class _FrameRecords(NamedTuple):
    """The n frames of a group."""

    codes: Any  # (n,): identifier in bits 0 to 28, 1 in bit 29 if it is extended, bus from 30 on
    time: Any  # [s] (n,)
    data: Any  # (n, bytes)
    length: Any  # [bytes] (n,)


def _frame_records(mdf: Any, number: int, where: str) -> _FrameRecords | None:
    """Return the frames of the group with this number, or None if it has none."""
    names = {c.name for c in mdf.groups[number].channels}
    cycles = int(mdf.groups[number].channel_group.cycles_nr)
    if f"{_FRAME}.DataBytes" not in names or not cycles:
        return None
    optional = [x for x in ("IDE", "BusChannel", "DataLength") if f"{_FRAME}.{x}" in names]
    with _readable(where, "frames"):
        fields = {x: mdf.get(f"{_FRAME}.{x}", group=number) for x in ("ID", *optional)}
        data = mdf.get(f"{_FRAME}.DataBytes", group=number).samples
    time = fields["ID"].timestamps
    numbers = {name: field.samples for name, field in fields.items()}
    if not len(data) == numbers["ID"].size == cycles:
        raise _too_few("frames", min(len(data), numbers["ID"].size), cycles, where)
    if data.ndim != 2 or any(x.ndim != 1 or x.dtype.kind not in "biuf" for x in numbers.values()):
        expected = "identifier, bus, length and bytes of each frame"
        raise damaged(where, "the fields of its frames are not numbers", expected)
    identifier = numbers["ID"].astype(np.int64)
    extended = numbers.get("IDE", identifier > 0x7FF).astype(bool)
    bus = numbers.get("BusChannel", np.zeros(cycles)).astype(np.int64)
    length = numbers.get("DataLength", np.full(cycles, data.shape[1]))
    if length.max(initial=0) > data.shape[1]:
        flaw = f"a frame has a length of {length.max()} bytes, its record {data.shape[1]}"
        raise damaged(where, flaw, "frames within their records")
    codes = bus << 30 | extended.astype(np.int64) << 29 | identifier & 0x1FFFFFFF
    return _FrameRecords(codes, time, data, length)


def _too_few(unit: str, readable: int, counted: int, where: str) -> LogError:
    flaw = f"{readable} of {counted} {unit} can be read: {counted - readable} are missing"
    return damaged(where, flaw, "all that the group counts")


@contextmanager
def _readable(where: str, part: str = "file") -> Iterator[None]:
    """Raise LogError instead of the exception, of any kind, that asammdf raises for damage."""
    try:
        yield
    except Exception as cause:
        flaw = f"asammdf cannot read the {part}: {str(cause) or type(cause).__name__}"
        raise damaged(where, flaw, "a complete and undamaged MDF file") from cause

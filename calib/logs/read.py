"""Read a log of any known format as a `Log` in SI."""

import hashlib
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Self

import numpy as np

from calib.base.arrays import Array
from calib.base.bounded import LOG, RECORDING, FileKind, open_bounded, read_bounded
from calib.base.errors import ChannelMapError, LogError
from calib.base.names import CHANNELS
from calib.base.plain import quoted
from calib.logs.channel_map import TRUTH, Assigned, ChannelMap, assign, without_unit
from calib.logs.clock import check_clock, is_ascending, on_line
from calib.logs.formats import RECORDINGS, TABLES, as_table, ending_of, refuse_other_kind, stem_of
from calib.logs.gaps import complete_channels, fill_rows, without_open_ends
from calib.logs.impossible import refuse_absurd, without_impossible
from calib.logs.log import Log
from calib.logs.resample import Resampled, of_several_clocks, on_one_clock, traces_of
from calib.logs.source import ColumnSource, Recording
from calib.logs.text.dialect import LOOKED

REQUIRED = tuple(q.name for q in CHANNELS.values() if q.required)
"""Channels that fit and validation need."""

FORMATS = (*TABLES, *RECORDINGS)
"""File name endings of all known formats."""

_WORKBOOKS = (".xlsx", ".xlsm", ".xls", ".ods")


@dataclass(frozen=True)
class _Opened:
    """An opened log, a context: its path, its columns, and the SHA-256 of its bytes."""

    path: Path
    source: ColumnSource | Recording
    digest: str

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        if isinstance(self.source, Recording):
            self.source.close()

    def table(self, taken: Mapping[int, Assigned] | None = None) -> ColumnSource:
        """All columns on one clock, as `as_table`."""
        if isinstance(self.source, ColumnSource):
            return self.source
        return as_table(self.source, str(self.path), taken)


def open_log(
    path: Path | str,
    channel_map: ChannelMap | None = None,
    *,
    data: bytes | None = None,
    file: Path | None = None,
) -> _Opened:
    """Open a log without assigning its columns to channels; of a map text format and DBC are used.

    ``path`` names it. ``data`` are its bytes, if known; ``file`` is where they are, if not at
    ``path``. Raises LogError for a file that is not a log, or not complete.
    """
    path = Path(path)
    ending = ending_of(path)
    if ending not in RECORDINGS:
        data = log_bytes(path) if data is None else data
        refuse_other_kind(data[:64], ending, path)
        text_format = channel_map.text if channel_map else LOOKED
        source = TABLES[ending](data, str(path), text_format)
        return _Opened(path, source, hashlib.sha256(data).hexdigest())
    place = Path(file or path)
    head, digest = _seen(place, path) if data is None else (data, hashlib.sha256(data).hexdigest())
    refuse_other_kind(head[:64], ending, path)
    databases = channel_map.databases if channel_map else {}
    return _Opened(path, RECORDINGS[ending](place, databases), digest)


def _seen(file: Path, where: Path) -> tuple[bytes, str]:
    with _as_log(file, where) as kind, open_bounded(file, kind) as stream:
        head = stream.read(64)
        stream.seek(0)
        return head, hashlib.file_digest(stream, "sha256").hexdigest()


def read_log(
    path: Path | str,
    channel_map: ChannelMap | Path | None = None,
    *,
    require: tuple[str, ...] = REQUIRED,
    data: bytes | None = None,
    file: Path | None = None,
) -> Log:
    """Read one run; the ending gives the format, ``channel_map`` names foreign columns.

    Channels in ``require`` must be there; others that are empty are left out, with a note. Raises
    LogError for a file that is not a valid log, ChannelMapError for a map that does not fit.

    >>> import calib
    >>> log = calib.read_log(calib.sample_logs() / "sedan" / "coast.csv")
    >>> log.name, log.time.size, round(log.sample_time, 6)  # s
    ('coast', 2000, 0.005)
    """
    if isinstance(channel_map, str | Path):
        from calib.logs.channel_map_file import read_channel_map

        channel_map = read_channel_map(channel_map)
    with open_log(path, channel_map, data=data, file=file) as opened:
        return read_opened(opened, channel_map, require=require)


def read_opened(
    opened: _Opened, channel_map: ChannelMap | None = None, *, require: tuple[str, ...] = REQUIRED
) -> Log:
    """Read one run from a log that was opened. Else like `read_log`."""
    needed, source = tuple(dict.fromkeys(("time", *require))), opened.source
    begun = Log(stem_of(opened.path), str(opened.path), opened.digest, {}, notes=source.notes)
    taken, ignored = assign(source.columns, channel_map, needed, begun.source)
    begun = replace(begun, ignored=ignored)
    if isinstance(source, ColumnSource):
        log = _rows(begun, source, taken)
    else:
        log = _recorded(begun, source, taken, channel_map)
    return _checked(log, taken, needed)


def _rows(log: Log, source: ColumnSource, taken: list[Assigned]) -> Log:
    written = source.read([item.index for item in taken])
    values = {item.channel: item.to_si(w) for item, w in zip(taken, written, strict=True)}
    time, log = values.pop("time"), _with_notes(log, without_unit(source.columns, taken))
    if of_several_clocks(time, values):
        by_name = {item.channel: item for item in taken}
        traces = [by_name[trace.name].named(trace) for trace in traces_of(time, values)]
        found = on_one_clock(traces, log.source)
        note = "the rows are those of several clocks: each channel was put on one clock"
        channels = {"time": found.time, **dict(zip(values, found.values, strict=True))}
        return _resampled(_with_notes(log, (note,)), found, channels)
    rounded: tuple[str, ...] = ()
    if is_ascending(time):
        time, rounded = on_line(time)
    measured = {name: x for name, x in values.items() if name in CHANNELS}
    filled, notes, bridged = fill_rows(measured, time)
    log = _with_notes(log, (*rounded, *notes))
    return replace(log, channels={"time": time} | values | filled, bridged=tuple(bridged))


def _with_notes(log: Log, notes: tuple[str, ...]) -> Log:
    return replace(log, notes=(*log.notes, *notes))


def _resampled(log: Log, found: Resampled, channels: dict[str, Array]) -> Log:
    return replace(
        log,
        channels=channels,
        notes=(*log.notes, *found.notes),
        bridged=found.bridged,
        interpolated=found.interpolated,
    )


def _recorded(
    log: Log, source: Recording, taken: list[Assigned], channel_map: ChannelMap | None
) -> Log:
    clock = recorded_clock(taken, channel_map)
    others = [item for item in taken if item is not clock]
    if not others:
        have = quoted(log.ignored) or "no channels"
        raise LogError(
            f"no channel of the log is known; it has {have}",
            where=log.source,
            expected=f"channels named {', '.join(REQUIRED[1:])}",
            do="; ".join([*log.notes, "name foreign channels in a channel map (--map)"]),
        )
    traces = source.read([item.index for item in others])
    found = on_one_clock([i.named(t) for i, t in zip(others, traces, strict=True)], log.source)
    written = zip((clock, *others), (found.time, *found.values), strict=True)
    log = _with_notes(log, without_unit(source.columns, taken))
    return _resampled(log, found, {item.channel: item.to_si(w) for item, w in written})


def _checked(log: Log, taken: list[Assigned], needed: tuple[str, ...]) -> Log:
    refuse_absurd(log.channels, log.source)
    possible, marked, more = without_impossible(log.channels, log.source)
    possible, moved = _in_time(possible, taken, log.source)
    cut, cut_notes = without_open_ends(possible)
    values, notes = complete_channels(cut, needed, log.source)
    unit = next(item.unit for item in taken if item.channel == "time")
    check_clock(values["time"], log.source, unit)
    return replace(
        log,
        channels={name: values[name] for name in CHANNELS if name in values},
        truth={name: v for name, v in values.items() if name.startswith(TRUTH)},
        notes=log.notes + moved + cut_notes + notes,
        origins=tuple(item.origin() for item in taken if item.channel in values),
        bridged=tuple(gap for gap in (*log.bridged, *more) if gap.channel in values),
        marked=marked,
    )


def _in_time(
    channels: dict[str, Array], taken: list[Assigned], where: str
) -> tuple[dict[str, Array], tuple[str, ...]]:
    """The channels without the delays of the map, in the rows that all have, and notes."""
    time = channels["time"]
    late = {item.channel: item.mapping.delay for item in taken if item.mapping.delay}
    if not late or not is_ascending(time):
        return channels, ()
    moved = {name: np.interp(time + delay, time, channels[name]) for name, delay in late.items()}
    moves = [
        f"{name} was put {abs(delay):g} s {'earlier' if delay > 0.0 else 'later'}"
        for name, delay in late.items()
    ]
    shifts = [0.0, *late.values()]
    kept = (time + min(shifts) >= time[0]) & (time + max(shifts) <= time[-1])
    if not kept.any():
        raise LogError(
            f"no time has all channels: {', '.join(moves)}",
            where=where,
            expected=f"delays within the {np.ptp(time):.3g} s of the log",
            do="correct the delay in the channel map",
        )
    return {name: x[kept] for name, x in (channels | moved).items()}, tuple(moves)


def recorded_clock(taken: list[Assigned], channel_map: ChannelMap | None) -> Assigned:
    """The time of a recording, which is its first column. Raises ChannelMapError if mapped."""
    clock = next(item for item in taken if item.channel == "time")
    if clock.index != 0:
        raise ChannelMapError(
            f"time is mapped to {clock.mapping.source!r}, but each channel of this log has its own",
            where=channel_map.where if channel_map else None,
            expected="no entry for time",
        )
    return clock


def log_bytes(path: Path, where: object = None, *, any_format: bool = False) -> bytes:
    """The bytes of a log; ``where`` names it. Raises LogError for no file of a known format."""
    with _as_log(path, path if where is None else where, any_format) as kind:
        return read_bounded(path, kind)


@contextmanager
def _as_log(path: Path, where: object, any_format: bool = False) -> Iterator[FileKind]:
    """The kind of file of a log; what the system says of one that cannot be read is a LogError."""
    ending = ending_of(path)
    try:
        if ending not in FORMATS and not any_format and path.is_file():
            raise LogError(
                f"unknown format {ending!r}",
                where=where,
                expected=f"one of {', '.join(FORMATS)}",
                do="a workbook: save its sheet as CSV" if ending in _WORKBOOKS else "",
            )
        yield LOG if ending in TABLES else RECORDING
    except (FileNotFoundError, NotADirectoryError) as cause:
        do = "check the path"
        raise LogError("no such file", where=where, expected="a log", do=do) from cause
    except OSError as cause:
        raise LogError(f"not readable: {cause.strerror}", where=where, expected="a log") from cause

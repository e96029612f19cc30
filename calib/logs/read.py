"""Read a log of any known format as a `Log` in SI."""

import hashlib
import stat
from dataclasses import dataclass, replace
from pathlib import Path

from calib.base.bounded import LOG, RECORDING, open_bounded, read_bounded
from calib.base.errors import ChannelMapError, LogError
from calib.base.names import CHANNELS
from calib.logs.assign import TRUTH, Assigned, assign, without_unit
from calib.logs.channel_map import ChannelMap, Databases
from calib.logs.clock import is_ascending, on_line
from calib.logs.formats import RECORDINGS, TABLES, as_source, ending_of, refuse_other_kind, stem_of
from calib.logs.gaps import fill_rows
from calib.logs.impossible import without_impossible
from calib.logs.log import Log
from calib.logs.resample import on_one_clock
from calib.logs.source import ColumnSource, Recording
from calib.logs.text.dialect import LOOKED
from calib.logs.verify import check_clock, complete_channels, refuse_absurd, without_open_ends

REQUIRED = tuple(q.name for q in CHANNELS.values() if q.required)
"""Channels that fit and validation need."""

FORMATS = (*TABLES, *RECORDINGS)
"""File name endings of all known formats."""

_WORKBOOKS = (".xlsx", ".xlsm", ".xls", ".ods")


@dataclass(frozen=True)
class Opened:
    """An opened log, and the SHA-256 of its bytes."""

    source: ColumnSource
    digest: str


def open_log(path: Path, channel_map: ChannelMap | None = None) -> Opened:
    """Open a log without assigning its columns to channels.

    Only the text format and the DBC files of ``channel_map`` are used. Raises LogError for a file
    that is not a log, or not complete.
    """
    path = Path(path)
    if ending_of(path) not in RECORDINGS:
        return open_bytes(log_bytes(path), path, channel_map)
    digest = recording_digest(path)
    return Opened(as_source(opened_recording(path, channel_map), str(path)), digest)


def opened_recording(
    path: Path, channel_map: ChannelMap | None = None, where: object = None
) -> Recording:
    """Open a log with several sample rates; the caller closes it. Else like `open_log`."""
    ending = ending_of(path)
    try:
        with path.open("rb") as file:
            refuse_other_kind(file.read(64), ending, where or path)
    except OSError as cause:
        raise _unreadable(where or path, cause) from cause
    return RECORDINGS[ending](path, channel_map.databases if channel_map else Databases())


def open_bytes(data: bytes, path: Path, channel_map: ChannelMap | None = None) -> Opened:
    """Open the bytes of a log that is a table; ``path`` names it. Else like `open_log`."""
    refuse_other_kind(data[:64], ending_of(path), path)
    text_format = channel_map.text if channel_map else LOOKED
    source = TABLES[ending_of(path)](data, str(path), text_format)
    return Opened(source, hashlib.sha256(data).hexdigest())


def recording_digest(path: Path) -> str:
    """SHA-256 of the bytes of a log with several sample rates. Raises as `refuse_no_log`."""
    refuse_no_log(path)
    try:
        with open_bounded(path, RECORDING) as file:
            return hashlib.file_digest(file, "sha256").hexdigest()
    except OSError as cause:
        raise _unreadable(path, cause) from cause


def read_log(
    path: Path | str,
    channel_map: ChannelMap | Path | None = None,
    *,
    require: tuple[str, ...] = REQUIRED,
) -> Log:
    """Read one run.

    The ending of ``path`` gives the format, ``channel_map`` names and units of foreign columns.
    Channels in ``require``, and ``time``, must be there; others that are empty are left out, with a
    note. The manoeuvre is not judged here, see `calib.run.check`.

    Raises LogError for a file that is not a valid log, see `calib.logs.verify` and
    `calib.logs.assign`; ChannelMapError for a map that does not fit.

    >>> import calib
    >>> log = calib.read_log(calib.sample_logs() / "sedan" / "coast.csv")
    >>> log.name, log.time.size, round(log.sample_time, 6)  # s
    ('coast', 2000, 0.005)
    """
    path = Path(path)
    if ending_of(path) not in RECORDINGS:
        return log_of(log_bytes(path), path, channel_map, require=require)
    return _recorded(path, recording_digest(path), path, _as_map(channel_map), require)


def read_opened(
    opened: Opened,
    path: Path,
    channel_map: ChannelMap | None = None,
    *,
    require: tuple[str, ...] = REQUIRED,
) -> Log:
    """Read one run from a table that `open_log` opened; ``path`` names it. Else like `read_log`."""
    source = opened.source
    taken, ignored = assign(source.columns, channel_map, _with_time(require), str(path))
    written = source.read([item.index for item in taken])
    values = {item.channel: item.to_si(w) for item, w in zip(taken, written, strict=True)}
    rounded: tuple[str, ...] = ()
    if is_ascending(values["time"]):
        values["time"], rounded = on_line(values["time"])
    measured = {name: x for name, x in values.items() if name in CHANNELS and name != "time"}
    filled, notes, bridged = fill_rows(measured, values["time"])
    log = Log(
        stem_of(path),
        str(path),
        opened.digest,
        values | filled,
        ignored=ignored,
        notes=(*source.notes, *without_unit(source.columns, taken), *rounded, *notes),
        bridged=tuple(bridged),
    )
    return _checked(log, taken, require)


def log_of(
    data: bytes,
    path: Path,
    channel_map: ChannelMap | Path | None = None,
    *,
    require: tuple[str, ...] = REQUIRED,
    file: Path | None = None,
) -> Log:
    """Read one run from its bytes; ``path`` names it. Else like `read_log`.

    ``file`` is the path of the bytes, if not ``path``: a recording is read from there.
    """
    path, mapped = Path(path), _as_map(channel_map)
    if ending_of(path) not in RECORDINGS:
        return read_opened(open_bytes(data, path, mapped), path, mapped, require=require)
    return _recorded(Path(file or path), hashlib.sha256(data).hexdigest(), path, mapped, require)


def _recorded(
    file: Path, digest: str, path: Path, channel_map: ChannelMap | None, require: tuple[str, ...]
) -> Log:
    where = str(path)
    opened = opened_recording(file, channel_map, where)
    try:
        taken, ignored = assign(opened.columns, channel_map, _with_time(require), where)
        clock = recorded_clock(taken, channel_map)
        others = [item for item in taken if item is not clock]
        if not others:
            have = ", ".join(map(repr, ignored)) or "no channels"
            raise LogError(
                f"no channel of the log is known; it has {have}",
                where=where,
                expected=f"channels named {', '.join(REQUIRED[1:])}",
                do="; ".join([*opened.notes, "name foreign channels in a channel map (--map)"]),
            )
        traces = opened.read([item.index for item in others])
    finally:
        opened.close()
    found = on_one_clock([i.wanted(t) for i, t in zip(others, traces, strict=True)], where)
    written = zip((clock, *others), (found.time, *found.values), strict=True)
    log = Log(
        stem_of(path),
        where,
        digest,
        {item.channel: item.to_si(w) for item, w in written},
        ignored=ignored,
        notes=(*opened.notes, *without_unit(opened.columns, taken), *found.notes),
        bridged=found.bridged,
        interpolated=found.interpolated,
    )
    return _checked(log, taken, require)


def _as_map(channel_map: ChannelMap | Path | None) -> ChannelMap | None:
    if not isinstance(channel_map, str | Path):
        return channel_map
    from calib.logs.channel_map_file import read_channel_map

    return read_channel_map(channel_map)


def _with_time(require: tuple[str, ...]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(("time", *require)))


def _checked(log: Log, taken: list[Assigned], require: tuple[str, ...]) -> Log:
    """The log with the channels that are whole, its truth apart. Raises LogError as `read_log`."""
    refuse_absurd(log.channels, log.source)
    possible, marked, more = without_impossible(log.channels, log.source)
    cut, cut_notes = without_open_ends(possible)
    values, notes = complete_channels(cut, _with_time(require), log.source)
    check_clock(values["time"], log.source)
    return replace(
        log,
        channels={name: values[name] for name in CHANNELS if name in values},
        truth={name: v for name, v in values.items() if name.startswith(TRUTH)},
        notes=log.notes + cut_notes + notes,
        origins=tuple(item.origin() for item in taken if item.channel in values),
        bridged=tuple(gap for gap in (*log.bridged, *more) if gap.channel in values),
        marked=marked,
    )


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


def _unreadable(where: object, cause: OSError) -> LogError:
    return LogError(f"not readable: {cause.strerror}", where=where)


def log_bytes(path: Path, where: object = None, *, any_format: bool = False) -> bytes:
    """The bytes of a log; ``where`` names it in messages.

    Raises LogError if ``path`` is not a readable file of a known format.
    """
    where = path if where is None else where
    refuse_no_log(path, where, any_format=any_format)
    try:
        return read_bounded(path, LOG if ending_of(path) in TABLES else RECORDING)
    except OSError as cause:
        raise _unreadable(where, cause) from cause


def refuse_no_log(path: Path, where: object = None, *, any_format: bool = False) -> None:
    """Raise LogError if ``path`` is not a file of a known format."""
    where = path if where is None else where
    try:
        mode = path.stat().st_mode
    except (FileNotFoundError, NotADirectoryError, ValueError) as cause:
        do = "check the path"
        raise LogError("no such file", where=where, expected="a log", do=do) from cause
    except OSError as cause:
        raise _unreadable(where, cause) from cause
    if not stat.S_ISREG(mode):
        what = "a directory" if stat.S_ISDIR(mode) else "a device, socket or pipe"
        raise LogError(what, where=where, expected="a log file")
    if ending_of(path) not in FORMATS and not any_format:
        raise LogError(
            f"unknown format {ending_of(path)!r}",
            where=where,
            expected=f"one of {', '.join(FORMATS)}",
            do="a workbook: save its sheet as CSV" if ending_of(path) in _WORKBOOKS else "",
        )

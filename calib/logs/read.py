"""Read a log of any known format: one file in, one Log in SI out."""

import hashlib
from dataclasses import dataclass
from pathlib import Path

from calib.errors import ChannelMapError, LogError
from calib.logs.assign import TRUTH, Assigned, assign
from calib.logs.channel_map import ChannelMap
from calib.logs.log import Array, Log, Origin
from calib.logs.recording import ChannelTrace
from calib.logs.recordings import RECORDINGS, as_source
from calib.logs.resample import Wanted, on_one_clock
from calib.logs.source import ColumnSource
from calib.logs.tables import TABLES, ending_of, stem_of
from calib.logs.text.dialect import LOOKED
from calib.logs.verify import check_clock, complete_channels
from calib.names import CHANNELS

REQUIRED = tuple(q.name for q in CHANNELS.values() if q.required)
"""Channels without which a log can neither be fitted nor validated."""

FORMATS = (*TABLES, *RECORDINGS)
"""The endings of files that can be read."""


@dataclass(frozen=True)
class Opened:
    """A log that was opened, and the SHA-256 of its bytes."""

    source: ColumnSource
    digest: str


def open_log(path: Path, channel_map: ChannelMap | None = None) -> Opened:
    """Open a log without deciding what its columns are.

    Of ``channel_map`` only what it says of the file's format is used. Raises LogError for a file
    that is none, or not whole.
    """
    path = Path(path)
    if ending_of(path) not in RECORDINGS:
        return _open_table(log_bytes(path), path, channel_map)
    refuse_no_log(path)
    digest = _digest(path)
    dbc = channel_map.dbc if channel_map else ()
    return Opened(as_source(RECORDINGS[ending_of(path)](path, dbc), str(path)), digest)


def _open_table(data: bytes, path: Path, channel_map: ChannelMap | None) -> Opened:
    told = channel_map.text if channel_map else LOOKED
    return Opened(TABLES[ending_of(path)](data, str(path), told), hashlib.sha256(data).hexdigest())


def _digest(path: Path) -> str:
    try:
        with path.open("rb") as file:
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

    Parameters
    ----------
    path : the log; its ending names the format.
    channel_map : names and units of foreign columns, as a file or already read.
    require : channels that must be there and not empty. ``time`` always is; an empty channel
        that is not required is left out and noted.

    Returns
    -------
    The log in SI. Truth channels (``true_``) are kept apart from the measured ones.

    Raises LogError for whatever makes the file no log: see `calib.logs.verify` and
    `calib.logs.assign`; ChannelMapError for a map that does not fit. It does not judge what was
    driven: that is `calib.checks.check`.

    >>> import calib
    >>> log = calib.read_log(calib.sample_logs() / "sedan" / "coast.csv")
    >>> log.name, log.time.size, round(log.sample_time, 6)  # s
    ('coast', 2000, 0.005)
    """
    path = Path(path)
    refuse_no_log(path)
    told = _told(channel_map)
    if ending_of(path) not in RECORDINGS:
        return read_opened(open_log(path, told), path, told, require=require)
    return _recorded(path, _digest(path), path, told, require)


def read_opened(
    opened: Opened,
    path: Path,
    channel_map: ChannelMap | None = None,
    *,
    require: tuple[str, ...] = REQUIRED,
) -> Log:
    """Read one run from a table that `open_log` opened; ``path`` names it. Else as `read_log`."""
    require = _needed(require)
    return _log(_read_table(opened, path, channel_map, require), path, require)


def log_of(
    data: bytes,
    path: Path,
    channel_map: ChannelMap | Path | None = None,
    *,
    require: tuple[str, ...] = REQUIRED,
    file: Path | None = None,
) -> Log:
    """Read one run whose bytes are at hand; ``path`` names it. Else as `read_log`.

    ``file`` is where the bytes lie, if not at ``path``: a recording is read from there.
    """
    path, told = Path(path), _told(channel_map)
    if ending_of(path) not in RECORDINGS:
        return read_opened(_open_table(data, path, told), path, told, require=require)
    return _recorded(Path(file or path), hashlib.sha256(data).hexdigest(), path, told, require)


def _recorded(
    file: Path, digest: str, path: Path, channel_map: ChannelMap | None, require: tuple[str, ...]
) -> Log:
    require = _needed(require)
    return _log(_read_recording(file, digest, str(path), channel_map, require), path, require)


def _told(channel_map: ChannelMap | Path | None) -> ChannelMap | None:
    if not isinstance(channel_map, str | Path):
        return channel_map
    from calib.logs.channel_map_file import read_channel_map

    return read_channel_map(channel_map)


def _needed(require: tuple[str, ...]) -> tuple[str, ...]:
    return ("time", *(name for name in require if name != "time"))


def _log(taken: "_Taken", path: Path, require: tuple[str, ...]) -> Log:
    """Check what was taken from a file, and put it in order."""
    values, notes = complete_channels(taken.values, require, str(path))
    check_clock(values["time"], str(path))
    return Log(
        name=stem_of(path),
        source=str(path),
        digest=taken.digest,
        origins=tuple(o for o in taken.origins if o.channel in values),
        channels={name: values[name] for name in CHANNELS if name in values},
        truth={name: v for name, v in values.items() if name.startswith(TRUTH)},
        ignored=taken.ignored,
        notes=taken.notes + notes,
    )


@dataclass(frozen=True)
class _Taken:
    """What was taken from a file: its digest, channels [SI], columns left, what was done."""

    digest: str
    values: dict[str, Array]
    origins: tuple[Origin, ...]
    ignored: tuple[str, ...]
    notes: tuple[str, ...]


def _read_table(
    opened: Opened, path: Path, channel_map: ChannelMap | None, require: tuple[str, ...]
) -> _Taken:
    source = opened.source
    taken, ignored = assign(source.columns, channel_map, require, str(path))
    written = source.read([item.index for item in taken])
    values = {item.channel: item.to_si(w) for item, w in zip(taken, written, strict=True)}
    return _Taken(opened.digest, values, _origins(taken), ignored, source.notes)


def _origins(taken: list[Assigned]) -> tuple[Origin, ...]:
    return tuple(item.origin() for item in taken)


def _read_recording(
    file: Path, digest: str, where: str, channel_map: ChannelMap | None, require: tuple[str, ...]
) -> _Taken:
    opened = RECORDINGS[ending_of(file)](file, channel_map.dbc if channel_map else ())
    try:
        taken, ignored = assign(opened.columns, channel_map, require, where)
        clock = next(item for item in taken if item.channel == "time")
        if clock.index != 0:
            raise _own_clock(clock, channel_map)
        others = [item for item in taken if item is not clock]
        if not others:
            raise _nothing_taken(ignored, opened.notes, where)
        traces = opened.read([item.index for item in others])
    finally:
        opened.close()
    resampled = on_one_clock([_wanted(i, t) for i, t in zip(others, traces, strict=True)], where)
    written = zip((clock, *others), (resampled.time, *resampled.values), strict=True)
    values = {item.channel: item.to_si(w) for item, w in written}
    return _Taken(digest, values, _origins(taken), ignored, opened.notes + resampled.notes)


def _own_clock(clock: Assigned, channel_map: ChannelMap | None) -> ChannelMapError:
    return ChannelMapError(
        f"time is mapped to {clock.mapping.source!r}, but each channel of this log has its own",
        where=channel_map.where if channel_map else None,
        expected="no entry for time",
        do="delete it",
    )


def _wanted(item: Assigned, trace: ChannelTrace) -> Wanted:
    method = item.mapping.method
    return Wanted(item.channel, trace, trace.state if method is None else method == "hold")


def _nothing_taken(ignored: tuple[str, ...], notes: tuple[str, ...], where: str) -> LogError:
    have = ", ".join(repr(name) for name in ignored) or "no channels"
    return LogError(
        f"none of its channels is known; it has {have}",
        where=where,
        expected=f"channels called {', '.join(REQUIRED[1:])}",
        do="; ".join([*notes, "name foreign channels in a channel map (--map)"]),
    )


def _unreadable(where: object, cause: OSError) -> LogError:
    return LogError(f"not readable: {cause.strerror}", where=where)


def log_bytes(path: Path, where: object = None, *, any_format: bool = False) -> bytes:
    """The file's bytes; ``where`` names it in messages.

    Raises LogError if it is not a readable file of a known format.
    """
    where = path if where is None else where
    refuse_no_log(path, where, any_format=any_format)
    try:
        return path.read_bytes()
    except OSError as cause:
        raise _unreadable(where, cause) from cause


def refuse_no_log(path: Path, where: object = None, *, any_format: bool = False) -> None:
    """Raise LogError if it is not a file of a known format."""
    where = path if where is None else where
    if path.is_dir():
        raise LogError("a directory", where=where, expected="a log file", do="name the files in it")
    if not path.exists():
        raise LogError("no such file", where=where, expected="a log", do="check the path")
    if not path.is_file():
        raise LogError("a device, socket or pipe", where=where, expected="a log file")
    if ending_of(path) not in FORMATS and not any_format:
        raise LogError(
            f"unknown format {ending_of(path)!r}",
            where=where,
            expected=f"one of {', '.join(FORMATS)}",
        )

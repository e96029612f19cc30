"""Read a log of any known format: one file in, one Log in SI out."""

import hashlib
from dataclasses import dataclass
from pathlib import Path

from calib.errors import LogError
from calib.logs.assign import TRUTH, assign
from calib.logs.channel_map import ChannelMap, read_channel_map
from calib.logs.dialect import LOOKED
from calib.logs.log import Log
from calib.logs.source import Source
from calib.logs.tables import TABLES, ending_of, stem_of
from calib.logs.verify import check_clock, complete_channels
from calib.names import CHANNELS

REQUIRED = tuple(q.name for q in CHANNELS.values() if q.required)
"""Channels without which a log can neither be fitted nor validated."""

FORMATS = tuple(TABLES)
"""The endings of files that can be read."""


@dataclass(frozen=True)
class Opened:
    """A log that was opened, and the SHA-256 of its bytes."""

    source: Source
    digest: str


def open_log(path: Path, channel_map: ChannelMap | None = None) -> Opened:
    """Open a log without deciding what its columns are.

    Of ``channel_map`` only what it says of the file's format is used. Raises LogError for a file
    that is none, or not whole.
    """
    path = Path(path)
    data = _bytes(path)
    told = channel_map.text if channel_map else LOOKED
    return Opened(TABLES[ending_of(path)](data, str(path), told), hashlib.sha256(data).hexdigest())


def read_log(
    path: Path,
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
    driven: that is `calib.check`.
    """
    path = Path(path)
    where = str(path)
    if isinstance(channel_map, str | Path):
        channel_map = read_channel_map(channel_map)
    opened = open_log(path, channel_map)
    source = opened.source
    require = ("time", *(name for name in require if name != "time"))
    taken, ignored = assign(source.columns, channel_map, require, where)
    written = source.read([item.index for item in taken])
    values = {item.channel: item.to_si(w) for item, w in zip(taken, written, strict=True)}
    values, notes = complete_channels(values, require, where)
    check_clock(values["time"], where)
    return Log(
        name=stem_of(path),
        source=where,
        digest=opened.digest,
        origins=tuple(item.origin() for item in taken if item.channel in values),
        channels={name: values[name] for name in CHANNELS if name in values},
        truth={name: v for name, v in values.items() if name.startswith(TRUTH)},
        ignored=ignored,
        notes=source.notes + notes,
    )


def _bytes(path: Path) -> bytes:
    """The file's bytes. Raises LogError if it is not a readable file of a known format."""
    if path.is_dir():
        raise LogError("a directory", where=path, expected="a log file", do="name the files in it")
    if not path.exists():
        raise LogError("no such file", where=path, expected="a log", do="check the path")
    if ending_of(path) not in FORMATS:
        raise LogError(
            f"unknown format {ending_of(path)!r}",
            where=path,
            expected=f"one of {', '.join(FORMATS)}",
        )
    try:
        return path.read_bytes()
    except OSError as cause:
        raise LogError(f"not readable: {cause.strerror}", where=path) from cause

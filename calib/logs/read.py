"""Read a log of any known format: one file in, one Log in SI out."""

import hashlib
from collections.abc import Callable
from pathlib import Path

from calib.errors import LogError
from calib.logs.assign import TRUTH, assign
from calib.logs.channel_map import ChannelMap, read_channel_map
from calib.logs.csv import open_csv
from calib.logs.log import Log
from calib.logs.parquet import open_parquet
from calib.logs.source import Source
from calib.logs.verify import check_clock, complete_channels
from calib.names import CHANNELS

REQUIRED = tuple(q.name for q in CHANNELS.values() if q.required)
"""Channels without which a log can neither be fitted nor validated."""

FORMATS: dict[str, Callable[[bytes, str], Source]] = {
    ".csv": open_csv,
    ".parquet": open_parquet,
}
"""One opener per file ending. A new format is one file and one line here."""


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
    return log_of(log_bytes(path), path, channel_map, require=require)


def log_of(
    data: bytes,
    path: Path,
    channel_map: ChannelMap | Path | None = None,
    *,
    require: tuple[str, ...] = REQUIRED,
) -> Log:
    """Read one run whose bytes are at hand; ``path`` names it. Else as `read_log`."""
    where = str(path)
    source = FORMATS[path.suffix.lower()](data, where)
    if isinstance(channel_map, str | Path):
        channel_map = read_channel_map(channel_map)
    require = ("time", *(name for name in require if name != "time"))
    taken, ignored = assign(source.columns, channel_map, require, where)
    written = source.read([item.index for item in taken])
    values = {item.channel: item.to_si(w) for item, w in zip(taken, written, strict=True)}
    values, notes = complete_channels(values, require, where)
    check_clock(values["time"], where)
    return Log(
        name=path.stem,
        source=where,
        digest=hashlib.sha256(data).hexdigest(),
        channels={name: values[name] for name in CHANNELS if name in values},
        truth={name: v for name, v in values.items() if name.startswith(TRUTH)},
        ignored=ignored,
        notes=source.notes + notes,
    )


def log_bytes(path: Path, where: object = None, *, any_format: bool = False) -> bytes:
    """The file's bytes; ``where`` names it in messages.

    Raises LogError if it is not a readable file of a known format.
    """
    where = path if where is None else where
    if path.is_dir():
        raise LogError("a directory", where=where, expected="a log file", do="name the files in it")
    if not path.exists():
        raise LogError("no such file", where=where, expected="a log", do="check the path")
    if path.suffix.lower() not in FORMATS and not any_format:
        raise LogError(
            f"unknown format {path.suffix!r}", where=where, expected=f"one of {', '.join(FORMATS)}"
        )
    try:
        return path.read_bytes()
    except OSError as cause:
        raise LogError(f"not readable: {cause.strerror}", where=where) from cause

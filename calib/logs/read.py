"""Read a log of any known format as a `Log` in SI.

file --open_log--> columns --assign--> channels --_sampled--> one clock
     --without_impossible--> no impossible samples --_without_delays--> no delays
     --without_open_ends--> no open ends --complete_channels--> finite channels --> Log
"""

import hashlib
from collections.abc import Iterator
from contextlib import closing, contextmanager
from pathlib import Path
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array
from calib.base.bounded import LOG, RECORDING, FileKind, errors_as, open_bounded, read_bounded
from calib.base.errors import ChannelMapError, LogError
from calib.base.names import CHANNELS, TRUTH
from calib.base.plain import quoted
from calib.logs.channel_map import MAP_IT, Assigned, ChannelMap, assign
from calib.logs.clock import check_clock, is_ascending
from calib.logs.computed import computed_pressures
from calib.logs.formats import RECORDINGS, TABLES, ending_of, refuse_other_kind, stem_of
from calib.logs.gaps import complete_channels, without_open_ends
from calib.logs.impossible import refuse_absurd, without_impossible
from calib.logs.log import Log
from calib.logs.resample import Resampled, on_one_clock, rows_on_one_clock
from calib.logs.source import ColumnSource, Recording
from calib.logs.text.dialect import DETECTED

REQUIRED = tuple(q.name for q in CHANNELS.values() if q.required)
"""Channels that fit and validation need."""
FORMATS = (*TABLES, *RECORDINGS)  # file name endings of all known formats
_WORKBOOKS = (".xlsx", ".xlsm", ".xls", ".ods")


class OpenLog(NamedTuple):
    """An opened log, and the SHA-256 of its bytes."""

    source: ColumnSource | Recording
    digest: str


@contextmanager
def open_log(
    path: Path | str,
    channel_map: ChannelMap | None = None,
    *,
    data: bytes | None = None,
    file: Path | None = None,
) -> Iterator[OpenLog]:
    """Open a log for the time of the context, with the columns of the file.

    The ending of ``path`` gives the format, and errors name it; ``file`` is read in its place.
    ``data`` are the bytes if they were read already, but a recording is read from its file.
    ``channel_map`` gives the text format and the DBC. Raises LogError for a file that is no log, or
    not complete.
    """
    path, file = Path(path), Path(file or path)
    ending = ending_of(path)
    if data is None and ending not in RECORDINGS:
        data = log_bytes(file, path)
    if data is not None:
        head, digest = data[:64], hashlib.sha256(data).hexdigest()
    else:
        kind = _kind_of(file, path)
        with errors_as(LogError, path, "a log"), open_bounded(file, kind) as stream:
            head = stream.read(64)
            stream.seek(0)
            digest = hashlib.file_digest(stream, "sha256").hexdigest()
    refuse_other_kind(head, ending, path)
    if ending in RECORDINGS:
        databases = channel_map.databases if channel_map else {}
        with closing(RECORDINGS[ending](file, databases)) as recording:
            yield OpenLog(recording, digest)
    else:
        text_format = channel_map.text if channel_map else DETECTED
        yield OpenLog(TABLES[ending](data or b"", str(path), text_format), digest)


def read_log(
    path: Path | str,
    channel_map: ChannelMap | Path | None = None,
    *,
    require: tuple[str, ...] = REQUIRED,
    data: bytes | None = None,
    file: Path | None = None,
) -> Log:
    """Read one run. The ending gives the format; ``channel_map`` says which columns are channels.

    Channels in ``require`` must have values; another channel without values is left out, with a
    note. ``data`` and ``file`` are as in `open_log`. Raises LogError for a file that is not a valid
    log, ChannelMapError for a map that does not fit.

    >>> import calib
    >>> log = calib.read_log(calib.sample_logs() / "sedan" / "coast.csv")
    >>> log.name, log.time.size, round(log.sample_time, 6)  # s
    ('coast', 2000, 0.005)
    """
    if isinstance(channel_map, str | Path):
        from calib.logs.channel_map_file import read_channel_map

        channel_map = read_channel_map(channel_map)
    needed, where = tuple(dict.fromkeys(("time", *require))), str(Path(path))
    with open_log(path, channel_map, data=data, file=file) as opened:
        source = opened.source
        assigned, ignored, unit_notes = assign(source.columns, channel_map, needed, where)
        if isinstance(source, Recording):
            refuse_mapped_time(assigned, channel_map)
            if len(assigned) == 1:  # the clock alone
                flaw = f"no channel of the log is known; it has {quoted(ignored) or 'no channels'}"
                expected = f"channels named {', '.join(REQUIRED[1:])}"
                do = "; ".join([*source.notes, MAP_IT])
                raise LogError(flaw, where=where, expected=expected, do=do)
        sampled, resampled = _sampled(source, assigned, where)
        refuse_absurd(sampled, where)
        plausible, marked, bridged = without_impossible(sampled, where)
        undelayed, delay_notes = _without_delays(plausible, assigned)
        trimmed, trim_notes = without_open_ends(undelayed)
        values, gap_notes = complete_channels(trimmed, needed, where)
        unit = next(item.unit for item in assigned if item.channel == "time")
        check_clock(values["time"], where, unit)
        read_notes = (*source.notes, *unit_notes, *resampled.notes)
        return Log(
            stem_of(Path(path)),
            where,
            opened.digest,
            channels={name: values[name] for name in CHANNELS if name in values},
            truth={name: v for name, v in values.items() if name.startswith(TRUTH)},
            ignored=ignored,
            notes=(*read_notes, *delay_notes, *trim_notes, *gap_notes),
            origins=tuple(item.origin() for item in assigned if item.channel in values),
            bridged=tuple(gap for gap in (*resampled.bridged, *bridged) if gap.channel in values),
            marked=marked,
            interpolated=resampled.interpolated,
            computed=tuple(computed_pressures(values, ignored, source)),
        )


def _sampled(
    source: ColumnSource | Recording, assigned: list[Assigned], where: str
) -> tuple[dict[str, Array], Resampled]:
    """Return the channels [SI] (n,) of a source on one clock, and how they were put on it."""
    if isinstance(source, Recording):
        others = [item for item in assigned if item.channel != "time"]
        traces = source.read([item.index for item in others])
        named = [item.named(trace) for item, trace in zip(others, traces, strict=True)]
        resampled = on_one_clock(named, where)
        pairs = zip(others, resampled.values, strict=True)
        channels = {item.channel: item.to_si(x) for item, x in pairs}
    else:
        written = source.read([item.index for item in assigned])
        channels = {item.channel: item.to_si(x) for item, x in zip(assigned, written, strict=True)}
        resampled = rows_on_one_clock(channels.pop("time"), channels, where)
        channels = dict(zip(channels, resampled.values, strict=True))
    return {"time": resampled.time} | channels, resampled


def _without_delays(
    channels: dict[str, Array], assigned: list[Assigned]
) -> tuple[dict[str, Array], list[str]]:
    """Undo the delays of the map; return the rows in which every channel has a value, and notes.

    If a channel was recorded d late, its value for time t stands in the log at t + d.
    """
    time = channels["time"]
    delays = {item.channel: item.mapping.delay for item in assigned if item.mapping.delay}
    if not delays or not is_ascending(time):
        return channels, []
    moved = {name: np.interp(time + delay, time, channels[name]) for name, delay in delays.items()}
    notes = [
        f"{name} was put {abs(delay):g} s {'earlier' if delay > 0.0 else 'later'}"
        for name, delay in delays.items()
    ]
    shifts = [0.0, *delays.values()]
    inside = (time + min(shifts) >= time[0]) & (time + max(shifts) <= time[-1])
    return {name: x[inside] for name, x in (channels | moved).items()}, notes


def refuse_mapped_time(assigned: list[Assigned], channel_map: ChannelMap | None) -> None:
    """Raise ChannelMapError if the map of a recording names a column for the time."""
    clock = next(item for item in assigned if item.channel == "time")
    if clock.index != 0:
        map_path = channel_map.where if channel_map else None
        source = clock.mapping.source
        flaw = f"time is mapped to {source!r}, but each channel of this log has its own"
        raise ChannelMapError(flaw, where=map_path, expected="no entry for time")


def log_bytes(path: Path, where: object) -> bytes:
    """Read the bytes of a log; errors name ``where``. Raises LogError for an unknown format."""
    with errors_as(LogError, where, "a log"):
        return read_bounded(path, _kind_of(path, where))


def _kind_of(path: Path, where: object) -> FileKind:
    """Return the kind of file, which bounds its size. Raises LogError for an unknown ending."""
    ending = ending_of(path)
    if ending not in FORMATS and path.is_file():  # a file that is missing is refused when opened
        expected = f"one of {', '.join(FORMATS)}"
        do = "a workbook: save its sheet as CSV" if ending in _WORKBOOKS else ""
        raise LogError(f"unknown format {ending!r}", where=where, expected=expected, do=do)
    return LOG if ending in TABLES else RECORDING

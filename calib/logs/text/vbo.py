"""Racelogic VBO: text in sections with satellite speed and channels of the car's bus.

[header]           one name a line; standard names may have a unit: ``velocity kmh``
[channel units]    one line for each name that is not standard; it may be empty. Where there are
                   fewer lines, they are of the last names, the channels of input modules
[column names]     one word for each column, in the order of [header]
[data]             samples, separated by blanks; time is HHMMSS.ss

Positions and the number of satellites are not converted, because they are not used. The satellite
speed over ground is the reference speed ``v``, unless the file has a channel of that name.
"""

import re
from collections.abc import Sequence

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.units import is_unit, spelling
from calib.logs.source import Column, ColumnSource
from calib.logs.text.cells import column_from_cell, over_midnight
from calib.logs.text.csv import TextRows
from calib.logs.text.dialect import TextFormat
from calib.logs.text.encoding import text_of, to_utf8

_STANDARD = (
    *("satellites", "time", "latitude", "longitude", "velocity", "heading", "height"),
    *("vertical velocity", "event", "trigger event time", "event 1 time"),
    *("longitudinal acceleration", "lateral acceleration", "long accel", "lat accel"),
    *("glonass satellites", "gps satellites", "solution type", "distance", "sampleperiod"),
)
"""Standard names: they have no line in [channel units]."""

_DATA = re.compile(rb"^\[\s*data\s*\][^\r\n]*\r?$", re.MULTILINE | re.IGNORECASE)


def open_vbo(data: bytes, where: str, text_format: TextFormat | None = None) -> ColumnSource:
    """Open a VBO file; ``text_format`` may give its encoding. Raises LogError as `open_csv`."""
    if not data or data.isspace():
        raise LogError("the file is empty", where=where, expected="a VBO file")
    data = to_utf8(data, where, text_format.encoding if text_format else None)
    texts, body, notes = _sections(data, where)
    columns, more = _columns(texts, where)
    if b"\t" in body or b"  " in body:
        body = re.sub(rb"[ \t]+", b" ", body)
    body = body.lstrip(b" ").replace(b" \r\n", b"\n").replace(b" \n", b"\n")
    body = body.replace(b"\n ", b"\n")
    if not body or body.isspace():
        raise LogError("a header and no samples", where=where, expected="at least 50 rows")
    rows = TextRows(body, 0, columns, where, separator=" ")
    end = rows.end()

    def read(indices: Sequence[int]) -> list[Array]:
        return [
            _seconds(x, where) if columns[i].name == "time" else x
            for i, x in zip(indices, rows.read(indices), strict=True)
        ]

    return ColumnSource(columns, read, (*notes, *more, *((end,) if end else ())))


def _sections(data: bytes, where: str) -> tuple[dict[str, list[str]], bytes, list[str]]:
    begin = _DATA.search(data)
    if begin is None:
        raise LogError(
            "no section [data]: not a VBO file, or cut off",
            where=where,
            expected="[header], [column names] and [data]",
        )
    head, note = text_of(data[: begin.start()])
    parts = re.split(r"^\[([^\]\r\n]+)\].*$", head, flags=re.MULTILINE)
    texts = {
        name.strip().lower(): [line.strip() for line in text.split("\n")[1:-1]]
        for name, text in zip(parts[1::2], parts[2::2], strict=True)
    }
    body = data[begin.end() :].lstrip(b"\r\n")
    for needed in ("header", "column names"):
        if not any(texts.get(needed, [])):
            raise LogError(f"no section [{needed}]", where=where, expected="names of the channels")
    return texts, body, [note] if note else []


def _columns(texts: dict[str, list[str]], where: str) -> tuple[tuple[Column, ...], list[str]]:
    header = [line for line in texts["header"] if line]
    short = " ".join(texts["column names"]).split()
    if len(header) != len(short):
        raise LogError(
            f"{len(header)} names in [header], {len(short)} in [column names]",
            where=where,
            expected="the same number in both",
        )
    by_index, notes = _units(texts.get("channel units", []), header)
    columns = []
    for i, (name, word) in enumerate(zip(header, short, strict=True)):
        unit = by_index.get(i)
        if name.lower() == "time":
            columns.append(Column("time", "s", word))
            continue
        # ``velocity kmh``, not ``Brake [bar]``
        if unit is None and (named := _unit_in_name(name)):
            plain = Column(name.rpartition(" ")[0], named)
        else:
            plain = column_from_cell(name)
        full = word if word != plain.name else ""
        columns.append(Column(plain.name, unit or plain.unit, full))
    if not any(c.name == "v" for c in columns):
        columns = [Column("v", c.unit, c.name) if c.name == "velocity" else c for c in columns]
    return tuple(columns), notes


def _units(lines: list[str], header: Sequence[str]) -> tuple[dict[int, str], list[str]]:
    """Units by position in the header, and a note if the number of lines does not fit.

    Tried in turn, until no unit in a name is contradicted: the lines are of all names that are not
    standard, of those that have no unit, of the last ones.
    """
    channels = [
        i
        for i, name in enumerate(header)
        if not any(name.lower() == s or name.lower().startswith(f"{s} ") for s in _STANDARD)
    ]
    bare = [i for i in channels if _unit_in_name(header[i]) is None]
    filled = len(lines)
    while filled and not lines[filled - 1]:
        filled -= 1  # a blank line ends the section, or belongs to a channel without a unit
    fits = f"[channel units] has {filled} lines for {len(channels)} channels: "
    choices = [channels] if filled <= len(channels) <= len(lines) else []
    choices += [bare] if filled == len(bare) else []
    choices += [channels[-filled:]] if 0 < filled < len(channels) else []
    for places in choices:
        pairs = zip(places, lines, strict=False)
        unit_of = {i: unit for i, unit in pairs if unit.lower() not in ("", "(null)")}
        named = {i: _unit_in_name(header[i]) or unit for i, unit in unit_of.items()}
        if all(spelling(named[i]) == spelling(unit) for i, unit in unit_of.items()):
            names = ", ".join(header[i] for i in places)
            note = f"{fits}they were taken for the last, {names}"
            return unit_of, [] if places in (channels, bare) else [note]
    return {}, [f"{fits}no unit was used"] if filled else []


def _unit_in_name(name: str) -> str | None:
    stem, _, last = name.rpartition(" ")
    return last if stem and is_unit(last) else None


def _seconds(written: Array, where: str) -> Array:
    """Seconds since the midnight before the first sample (n,), from HHMMSS.ss."""
    # Rounded to the file's resolution: 120000.05 and its binary neighbours differ by 1e-11.
    hours, minutes_seconds = np.divmod(written, 10000.0)
    minutes, seconds = np.divmod(minutes_seconds, 100.0)
    wrong = np.flatnonzero(~((hours < 24) & (minutes < 60) & (seconds < 60)))
    if wrong.size:
        raise LogError(
            f"row {wrong[0] + 1}: {written[wrong[0]]:.10g} is not a time of day",
            where=f"{where}: time",
            expected="HHMMSS.ss",
        )
    time = np.round(3600.0 * hours + 60.0 * minutes + seconds, 6)
    return over_midnight(time)

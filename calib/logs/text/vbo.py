"""Read Racelogic VBO: text in sections with satellite speed and channels of the car's bus.

[header]           one name in each line; standard names may have a unit: ``velocity kmh``
[channel units]    one line, perhaps empty, for each name that is not standard; if there are fewer
                   lines, they belong to the last names, the channels of input modules
[column names]     one word for each column, in the order of [header]
[data]             samples, separated by blanks; time is HHMMSS.ss

The speed ``velocity`` over ground is the reference speed ``v``, unless a channel has the name
``v``. Positions and the number of satellites are not converted.
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
from calib.logs.text.dialect import DETECTED, TextFormat
from calib.logs.text.encoding import text_of, to_utf8

_STANDARD = (
    "satellites", "time", "latitude", "longitude", "velocity", "heading", "height",
    "vertical velocity", "event", "trigger event time", "event 1 time",
    "longitudinal acceleration", "lateral acceleration", "long accel", "lat accel",
    "glonass satellites", "gps satellites", "solution type", "distance", "sampleperiod",
)  # fmt: skip
"""Names that have no line in [channel units]."""

_DATA = re.compile(rb"^\[\s*data\s*\][^\r\n]*\r?$", re.MULTILINE | re.IGNORECASE)


def open_vbo(data: bytes, where: str, text_format: TextFormat = DETECTED) -> ColumnSource:
    """Open a VBO file; of ``text_format`` the encoding is used. Raises LogError as `open_csv`."""
    if not data or data.isspace():
        raise LogError("the file is empty", where=where, expected="a VBO file")
    data = to_utf8(data, where, text_format.encoding)
    sections, body, text_notes = _sections(data, where)
    columns, unit_notes = _columns(sections, where)
    # leave one blank between two cells, and none at either end of a row
    if b"\t" in body or b"  " in body:
        body = re.sub(rb"[ \t]+", b" ", body)
    body = body.lstrip(b" ").replace(b" \r\n", b"\n").replace(b" \n", b"\n")
    body = body.replace(b"\n ", b"\n")
    if not body or body.isspace():
        raise LogError("a header and no samples", where=where, expected="at least 50 rows")
    rows = TextRows(body, 0, columns, where, separator=" ")
    end_note = rows.check_end()

    def read(indices: Sequence[int]) -> list[Array]:
        return [
            _seconds(x, where) if columns[i].name == "time" else x
            for i, x in zip(indices, rows.read(indices), strict=True)
        ]

    notes = tuple(filter(None, (*text_notes, *unit_notes, end_note)))
    return ColumnSource(columns, read, notes)


def _sections(data: bytes, where: str) -> tuple[dict[str, list[str]], bytes, list[str]]:
    """Return the lines of each section by name, the bytes of [data], and a note on the encoding."""
    begin = _DATA.search(data)
    if begin is None:
        flaw = "no section [data]: not a VBO file, or cut off"
        raise LogError(flaw, where=where, expected="[header], [column names] and [data]")
    head, note = text_of(data[: begin.start()])
    parts = re.split(r"^\[([^\]\r\n]+)\].*$", head, flags=re.MULTILINE)
    sections = {
        name.strip().lower(): [line.strip() for line in text.split("\n")[1:-1]]
        for name, text in zip(parts[1::2], parts[2::2], strict=True)
    }
    body = data[begin.end() :].lstrip(b"\r\n")
    for needed in ("header", "column names"):
        if not any(sections.get(needed, [])):
            raise LogError(f"no section [{needed}]", where=where, expected="names of the channels")
    return sections, body, [note] if note else []


def _columns(sections: dict[str, list[str]], where: str) -> tuple[tuple[Column, ...], list[str]]:
    names = [line for line in sections["header"] if line]
    short_names = " ".join(sections["column names"]).split()
    if len(names) != len(short_names):
        flaw = f"{len(names)} names in [header], {len(short_names)} in [column names]"
        raise LogError(flaw, where=where, expected="the same number in both")
    units, notes = _units(sections.get("channel units", []), names)
    columns = []
    for i, (name, short_name) in enumerate(zip(names, short_names, strict=True)):
        if name.lower() == "time":
            columns.append(Column("time", "s", short_name))
            continue
        column = column_from_cell(name)  # ``Brake [bar]``
        if i not in units and (unit := _unit_in_name(name)):  # ``velocity kmh``
            column = Column(name.rpartition(" ")[0], unit)
        full = short_name if short_name != column.name else ""
        columns.append(Column(column.name, units.get(i) or column.unit, full))
    if not any(c.name == "v" for c in columns):
        columns = [Column("v", c.unit, c.name) if c.name == "velocity" else c for c in columns]
    return tuple(columns), notes


def _units(lines: list[str], names: Sequence[str]) -> tuple[dict[int, str], list[str]]:
    """Return the units by index of the name, from the lines of [channel units], and a note.

    A channel is a name that is not standard. The lines may belong to all channels, to those without
    a unit in the name, or to the last channels. The first of these choices is taken whose units
    agree with those in the names.
    """
    standard = tuple(f"{name} " for name in _STANDARD)  # what follows the blank may be a unit
    channels = [i for i, name in enumerate(names) if not f"{name.lower()} ".startswith(standard)]
    without_unit = [i for i in channels if _unit_in_name(names[i]) is None]
    count = len(lines)  # of lines up to the last that is not blank
    while count and not lines[count - 1]:
        count -= 1
    choices = []
    if count <= len(channels) <= len(lines):  # blank lines belong to channels without a unit
        choices.append(channels)
    if count == len(without_unit):
        choices.append(without_unit)
    if 0 < count < len(channels):
        choices.append(channels[-count:])
    note = f"[channel units] has {count} lines for {len(channels)} channels"
    for indices in choices:
        pairs = zip(indices, lines, strict=False)
        units = {i: unit for i, unit in pairs if unit.lower() not in ("", "(null)")}
        # a name without a unit agrees with any
        in_names = {i: _unit_in_name(names[i]) or unit for i, unit in units.items()}
        if all(spelling(in_names[i]) == spelling(unit) for i, unit in units.items()):
            if indices in (channels, without_unit):
                return units, []
            last = ", ".join(names[i] for i in indices)
            return units, [f"{note}: they were taken for the last, {last}"]
    return {}, [f"{note}: no unit was used"] if count else []


def _unit_in_name(name: str) -> str | None:
    stem, _, last = name.rpartition(" ")
    return last if stem and is_unit(last) else None


def _seconds(written: Array, where: str) -> Array:
    """Convert times of day HHMMSS.ss (n,) to seconds since midnight before the first row."""
    # the sum is rounded to microseconds, since 120000.05 has no exact binary value
    hours, minutes_seconds = np.divmod(written, 10000.0)
    minutes, seconds = np.divmod(minutes_seconds, 100.0)
    wrong = np.flatnonzero(~((hours < 24) & (minutes < 60) & (seconds < 60)))
    if wrong.size:
        flaw = f"row {wrong[0] + 1}: {written[wrong[0]]:.10g} is not a time of day"
        raise LogError(flaw, where=f"{where}: time", expected="HHMMSS.ss")
    time = np.round(3600.0 * hours + 60.0 * minutes + seconds, 6)
    return over_midnight(time)

"""The cells of a table: name and unit in the header, times of day below it.

name [unit]    always a name and a unit
name (unit)    if the text in brackets is a unit, or if the name is a canonical channel
name|unit|...  always; lowest and highest value and rate may follow
name_unit      if the ending can only be a unit of a channel, or if the name is a canonical channel
               and the ending a unit of it: ``time_s`` but not ``valve_s``

14:03:07,120       2026-03-14T14:03:07.120+01:00       14-Mar-2026 2:03:07.120 PM       03:07.120
0.12 sec           number and unit of time

Only the time of day is used: a date in any language changes at midnight, and a run is shorter than
half a day.
"""

import re
from collections.abc import Sequence

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.names import CHANNELS, TRUTH
from calib.base.units import is_unit, spelling, to_si
from calib.logs.clock import REPEATED
from calib.logs.source import Column


def column_from_cell(cell: str) -> Column:
    """Split a header cell into name and unit."""
    cell = cell.strip()
    parts = _split(cell, "[", "]")
    if parts is None and "|" in cell:
        name, unit, *_ = cell.split("|", 2)
        parts = name.strip('" '), unit.strip('" ')
    if parts is None and (rounded := _split(cell, "(", ")")) and rounded[0]:
        ours = rounded[0] in CHANNELS or rounded[0].startswith(TRUTH)
        parts = rounded if ours or is_unit(rounded[1]) else None
    parts = parts or _ending(cell)
    if parts is None:
        return Column(cell, None)
    name, unit = parts
    return Column(name, unit.strip(), "" if cell == f"{name} [{unit}]" else cell)


def _split(cell: str, opening: str, closing: str) -> tuple[str, str] | None:
    # An expression would take cubic time for a cell of many blanks.
    name, bracket, unit = cell.rpartition(opening)
    if not bracket or not unit.endswith(closing) or closing in unit[:-1]:
        return None
    return name.strip(), unit[:-1]


def _ending(cell: str) -> tuple[str, str] | None:
    if cell in CHANNELS:
        return None
    parts = cell.split("_")
    for count in (2, 1):  # m_s before s
        name, unit = "_".join(parts[:-count]), "/".join(parts[-count:])
        ours = [CHANNELS[name]] if name in CHANNELS else []
        # two letters may mean something else, and so does the lowest value
        clear = name and len(unit) > 2 and unit != "min"
        others = CHANNELS.values() if clear or (name and unit == "Nm") else []
        if any(is_unit(unit, quantity.si) for quantity in ours or others):
            return name, spelling(unit)
    return None


def is_unit_row(cells: Sequence[str]) -> bool:
    """Whether a row below the names has units: no number and at least one unit."""
    words = [text for text in map(_bare_unit, cells) if text and text != "1"]
    return not any(map(_NUMERIC.fullmatch, words)) and any(map(is_unit, words))


_NUMERIC = re.compile(r"[-+]?[\d.,]+([eE][-+]?\d+)?")


def _bare_unit(cell: str) -> str:
    """The unit without brackets: ``[bar]`` and ``(bar)`` are ``bar``."""
    text = cell.strip()
    if len(text) > 1 and text[0] + text[-1] in ("[]", "()", "{}", "<>"):
        text = text[1:-1].strip()
    return text


def with_unit_row(columns: Sequence[Column], cells: Sequence[str], where: str) -> list[Column]:
    """Columns with the units of a second header row. Raises LogError for a column with two."""
    out = []
    for column, cell in zip(columns, cells, strict=True):
        unit = _bare_unit(cell)
        if unit and column.unit and spelling(unit) != spelling(column.unit):
            raise LogError(
                f"the header has two units: {column.unit!r} and, in the row below, {unit!r}",
                where=f"{where}: {column.name}",
                expected="one unit",
                do="correct the header",
            )
        out.append(Column(column.name, column.unit or unit or None, column.full))
    return out


DAY, HOUR = 86400.0, 3600.0
"""Periods [s]: a clock with hours restarts at midnight, one with minutes at the full hour."""

_TIME = re.compile(
    r"(?:[^:]*[\sT_])?"  # weekday, date
    r"(?:(?P<h>\d{1,2}):)?(?P<m>[0-5]?\d):(?P<s>[0-5]?\d(?:[.,:]\d+)?)"
    r"(?:\s*(?P<half>[AaPp])\.?[Mm]\.?)?"
    r"(?:\s*(?:Z|[A-Z]{2,5})?\s*(?:[+-]\d{2}:?(?:\d{2})?)?(?:\s\d{4})?)"  # zone, year
)


_COUNTED = re.compile(r"([-+]?\d++(?:[.,]\d++)?)\s*([a-zµμ]++)", re.IGNORECASE)
"""A number with its unit behind."""


def is_clock(cell: str) -> bool:
    """Whether a cell is a number with a unit of time, or a time of day with seconds.

    Minutes and seconds alone, ``03:07.1``, are one if they have parts of a second.
    """
    match = _TIME.fullmatch(cell)
    of_day = match is not None and (match["h"] is not None or not match["s"].isdigit())
    return of_day or (match is None and _seconds(cell) is not None)


def _seconds(cell: str) -> tuple[float, float] | None:
    """Seconds of a time of day, or of a number with a unit of time, and the period of its clock."""
    if counted := _COUNTED.fullmatch(cell):
        number = float(counted[1].replace(",", "."))
        return (to_si(number, counted[2], "s"), HOUR) if is_unit(counted[2], "s") else None
    match = _TIME.fullmatch(cell)
    if match is None:
        return None
    hours = int(match["h"] or 0)
    if match["half"]:
        hours = hours % 12 + 12 * (match["half"] in "Pp")
    seconds = float(match["s"].replace(",", ".").replace(":", "."))
    time = 3600.0 * hours + 60.0 * int(match["m"]) + seconds
    return round(time, 9), DAY if match["h"] else HOUR


def clock_seconds(cells: Sequence[str | None], empty: Sequence[str], where: str) -> Array:
    """Seconds from the first row, (n,); NaN for a cell in ``empty``. Raises LogError for others."""
    values, period = np.full(len(cells), np.nan), HOUR
    for row, cell in enumerate(cells):
        text = (cell or "").strip()
        if text in empty or not text:
            continue
        if (read := _seconds(text)) is None:
            raise LogError(
                f"row {row + 1}: {text[:60]!r} is not a time of day",
                where=where,
                expected="the form of the other rows, such as 14:03:07.120",
            )
        values[row], period = read[0], max(period, read[1])
    return from_first(over_midnight(values, period), where)


def over_midnight(time: Array, period: float = DAY) -> Array:
    """``time`` [s] (n,) without the restarts of a clock that begins again after ``period`` [s]."""
    present = time[~np.isnan(time)]
    restarts = np.cumsum(np.diff(present, prepend=present[:1]) < -period / 2)
    result = time.copy()
    result[~np.isnan(time)] = present + period * restarts
    return result


def from_first(time: Array, where: str) -> Array:
    """``time`` [s], (n,), counted from its first value. Raises LogError for a clock too coarse."""
    present = time[~np.isnan(time)]
    same = int(np.count_nonzero(np.diff(present) == 0.0))
    if same > REPEATED * time.size:
        raise LogError(
            f"the clock is too coarse: {same} of {time.size} rows have the time of the row before",
            where=where,
            expected="a time of its own for each row",
            do="export the time with parts of a second, or as seconds from the start of the log",
        )
    return np.round(time - present[0], 9) if present.size else time

"""Read cells of a table: names and units in the header, times below it.

Header cells that are read as a name and a unit:
name [unit]    always
name (unit)    if the text in brackets is a unit, or the name is that of a channel
name|unit|...  always; lowest and highest value and rate may follow
name_unit      if the name is that of a channel and the ending a unit of it; or if the ending is a
               unit of some channel and longer than two letters: ``brake_bar``, not ``valve_s``

Cells that are read as times; a date is left out:
14:03:07,120    2026-03-14T14:03:07.120+01:00    14-Mar-2026 2:03:07.120 PM    03:07.120    0.12 sec

A clock that goes back by more than half a day has passed midnight. A clock without hours, also a
number with a unit, has passed the full hour if it goes back by more than half an hour.
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

EMPTY = ("", "nan", "NaN", "NAN", "NA", "N/A", "null")  # cells without a value


def column_from_cell(cell: str) -> Column:
    """Split a header cell into name and unit; a cell of another form is also the full name."""
    cell = cell.strip()
    parts = _split_brackets(cell, "[", "]")
    if parts is None and "|" in cell:
        name, unit, *_ = cell.split("|", 2)
        parts = name.strip('" '), unit.strip('" ')
    if parts is None and (in_round := _split_brackets(cell, "(", ")")):
        name, unit = in_round
        is_channel = name in CHANNELS or name.startswith(TRUTH)
        if name and (is_channel or is_unit(unit)):
            parts = in_round
    parts = parts or _split_ending(cell)
    if parts is None:
        return Column(cell, None)
    name, unit = parts
    has_usual_form = cell == f"{name} [{unit}]"  # which `Column.addresses` has in any case
    return Column(name, unit.strip(), "" if has_usual_form else cell)


def _split_brackets(cell: str, opening: str, closing: str) -> tuple[str, str] | None:
    # a regular expression would take cubic time for a cell of many blanks
    name, bracket, unit = cell.rpartition(opening)
    if not bracket or not unit.endswith(closing) or closing in unit[:-1]:
        return None
    return name.strip(), unit[:-1]


def _split_ending(cell: str) -> tuple[str, str] | None:
    if cell in CHANNELS:
        return None
    words = cell.split("_")
    for count in (2, 1):  # ``m_s`` is tried before ``s``
        name, unit = "_".join(words[:-count]), "/".join(words[-count:])
        if name in CHANNELS:
            is_ending = is_unit(unit, CHANNELS[name].si)
        else:  # one or two letters may mean something else than a unit, and "min" the lowest value
            is_clear = bool(name) and unit != "min" and (len(unit) > 2 or unit == "Nm")
            is_ending = is_clear and any(is_unit(unit, q.si) for q in CHANNELS.values())
        if is_ending:
            return name, spelling(unit)
    return None


def is_unit_row(cells: Sequence[str]) -> bool:
    """Whether a row below the names holds units: no number, and at least one unit."""
    texts = [text for text in map(_without_brackets, cells) if text and text != "1"]
    return not any(map(_NUMERIC.fullmatch, texts)) and any(map(is_unit, texts))


_NUMERIC = re.compile(r"[-+]?[\d.,]+([eE][-+]?\d+)?")


def _without_brackets(cell: str) -> str:
    text = cell.strip()
    if len(text) > 1 and text[0] + text[-1] in ("[]", "()", "{}", "<>"):
        text = text[1:-1].strip()
    return text


def with_unit_row(columns: Sequence[Column], cells: Sequence[str], where: str) -> list[Column]:
    """Give the columns the units of a row below the names. Raises LogError for a second unit."""
    result = []
    for column, cell in zip(columns, cells, strict=True):
        unit = _without_brackets(cell)
        if unit and column.unit and spelling(unit) != spelling(column.unit):
            flaw = f"the header has two units: {column.unit!r} and, in the row below, {unit!r}"
            place, do = f"{where}: {column.name}", "correct the header"
            raise LogError(flaw, where=place, expected="one unit", do=do)
        result.append(Column(column.name, column.unit or unit or None, column.full))
    return result


DAY, HOUR = 86400.0, 3600.0
"""Periods [s]: a clock with hours restarts at midnight, a clock without them at the full hour."""

_TIME = re.compile(
    r"(?:[^:]*[\sT_])?"  # weekday, date
    r"(?:(?P<h>\d{1,2}):)?(?P<m>[0-5]?\d):(?P<s>[0-5]?\d(?:[.,:]\d+)?)"
    r"(?:\s*(?P<half>[AaPp])\.?[Mm]\.?)?"  # AM or PM
    r"(?:\s*(?:Z|[A-Z]{2,5})?\s*(?:[+-]\d{2}:?(?:\d{2})?)?(?:\s\d{4})?)"  # zone, year
)
_WITH_UNIT = re.compile(r"([-+]?\d++(?:[.,]\d++)?)\s*([a-zµμ]++)", re.IGNORECASE)


def is_clock(cell: str) -> bool:
    """Whether a cell is a number with a unit of time, or a time of day with seconds.

    Minutes and seconds alone count if there are parts of a second, as in ``03:07.1``.
    """
    match = _TIME.fullmatch(cell)
    if match is None:
        return _seconds(cell) is not None
    return match["h"] is not None or not match["s"].isdigit()


def _seconds(cell: str) -> tuple[float, float] | None:
    """Time in a cell [s], and period of its clock [s]; None if the cell is no time."""
    if parts := _WITH_UNIT.fullmatch(cell):
        number, unit = float(parts[1].replace(",", ".")), parts[2]
        return (to_si(number, unit, "s"), HOUR) if is_unit(unit, "s") else None
    match = _TIME.fullmatch(cell)
    if match is None:
        return None
    hours = int(match["h"] or 0)
    if match["half"]:
        hours = hours % 12 + (12 if match["half"] in "Pp" else 0)
    seconds = float(match["s"].replace(",", ".").replace(":", "."))
    time = HOUR * hours + 60.0 * int(match["m"]) + seconds
    return round(time, 9), DAY if match["h"] else HOUR


def clock_seconds(cells: Sequence[str | None], where: str) -> Array:
    """Read times [s] since the first row (n,), NaN if `EMPTY`. Raises LogError for other cells."""
    values, period = np.full(len(cells), np.nan), HOUR
    for row, cell in enumerate(cells):
        text = (cell or "").strip()
        if text in EMPTY:
            continue
        seconds = _seconds(text)
        if seconds is None:
            flaw = f"row {row + 1}: {text[:60]!r} is not a time of day"
            expected = "the form of the other rows, such as 14:03:07.120"
            raise LogError(flaw, where=where, expected=expected)
        values[row], period = seconds[0], max(period, seconds[1])
    return from_first(over_midnight(values, period), where)


def over_midnight(time: Array, period: float = DAY) -> Array:
    """Undo the restarts of a clock with this ``period`` [s] in ``time`` [s] (n,); NaN stays."""
    present = time[~np.isnan(time)]
    restarts = np.cumsum(np.diff(present, prepend=present[:1]) < -period / 2)
    result = time.copy()
    result[~np.isnan(time)] = present + period * restarts
    return result


def from_first(time: Array, where: str) -> Array:
    """Count ``time`` [s] (n,) from its first value. Raises LogError for a clock too coarse."""
    present = time[~np.isnan(time)]
    repeated = int(np.count_nonzero(np.diff(present) == 0.0))
    if repeated > REPEATED * time.size:
        rows = f"{repeated} of {time.size} rows have the time of the row before"
        expected = "a time of its own for each row"
        do = "export the time with parts of a second, or as seconds from the start of the log"
        raise LogError(f"the clock is too coarse: {rows}", where=where, expected=expected, do=do)
    return np.round(time - present[0], 9) if present.size else time

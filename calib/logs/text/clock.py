"""A time of day as text: clock times and time stamps, read as seconds from the first row.

14:03:07,120       2026-03-14T14:03:07.120+01:00       14-Mar-2026 2:03:07.120 PM       03:07.120

Only the time of day is used: a date in any language changes at midnight, and a run is shorter than
half a day.
"""

import re
from collections.abc import Sequence

import numpy as np

from calib.errors import LogError
from calib.logs.source import Array

DAY, HOUR = 86400.0, 3600.0
"""Periods [s]: a clock with hours restarts at midnight, one with minutes at the full hour."""
REPEATED = 0.01
"""Largest share of rows [1] that repeat the time of the row before them."""

_TIME = re.compile(
    r"(?:[^:]*[\sT_])?"  # weekday, date
    r"(?:(?P<h>\d{1,2}):)?(?P<m>[0-5]?\d):(?P<s>[0-5]?\d(?:[.,:]\d+)?)"
    r"(?:\s*(?P<half>[AaPp])\.?[Mm]\.?)?"
    r"(?:\s*(?:Z|[A-Z]{2,5})?\s*(?:[+-]\d{2}:?(?:\d{2})?)?(?:\s\d{4})?)"  # zone, year
)


def is_clock(cell: str) -> bool:
    """Whether a cell is a time of day with seconds; without hours, with parts of a second.

    >>> [is_clock(cell) for cell in ("14:03:07,120", "2026-03-14T14:03:07Z", "03:07.1", "14:03")]
    [True, True, True, False]
    """
    found = _TIME.fullmatch(cell)
    return found is not None and (found["h"] is not None or not found["s"].isdigit())


def clock_seconds(cells: Sequence[str | None], empty: Sequence[str], where: str) -> Array:
    """Seconds from the first row, shape (n,); NaN for a cell in ``empty``.

    Raises LogError for a cell that is no time of day, and for a clock that repeats its values.

    >>> clock_seconds(["23:59:59.5", "0:00:00.5"], (), "run.csv")
    array([0., 1.])
    """
    values = np.full(len(cells), np.nan)
    period = HOUR
    for row, cell in enumerate(cells):
        text = (cell or "").strip()
        if text in empty or not text:
            continue
        found = _TIME.fullmatch(text)
        if found is None:
            raise LogError(
                f"row {row + 1}: {text!r} is not a time of day",
                where=where,
                expected="the form of the other rows, such as 14:03:07.120",
            )
        period = DAY if found["h"] else period
        values[row] = _seconds(found)
    return from_first(over_midnight(values, period), where)


def _seconds(found: re.Match[str]) -> float:
    """Seconds since midnight, or since the full hour."""
    whole, _, part = found["s"].replace(",", ".").replace(":", ".").partition(".")
    hours = int(found["h"] or 0)
    if found["half"]:
        hours = hours % 12 + 12 * (found["half"] in "Pp")
    return round(3600.0 * hours + 60.0 * int(found["m"]) + float(f"{whole}.{part or 0}"), 9)


def over_midnight(time: Array, period: float = DAY) -> Array:
    """``time`` [s], shape (n,), of a clock that restarts after ``period`` [s], without restarts.

    >>> over_midnight(np.array([86399.5, 0.5]))
    array([86399.5, 86400.5])
    """
    known = time[~np.isnan(time)]
    restarts = np.cumsum(np.diff(known, prepend=known[:1]) < -period / 2)
    result = time.copy()
    result[~np.isnan(time)] = known + period * restarts
    return result


def from_first(time: Array, where: str) -> Array:
    """``time`` [s], shape (n,), counted from its first value.

    Raises LogError for a clock that is too coarse: more than `REPEATED` of its rows repeat a time.
    """
    known = time[~np.isnan(time)]
    same = int(np.count_nonzero(np.diff(known) == 0.0))
    if same > REPEATED * time.size:
        raise LogError(
            f"the clock is too coarse: {same} of {time.size} rows have the time of the row before",
            where=where,
            expected="a time of its own for each row",
            do="export the time with parts of a second, or as seconds from the start of the log",
        )
    return np.round(time - known[0], 9) if known.size else time

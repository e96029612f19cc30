"""Every metric by its key in JSON files and limits files, from `metrics.csv`.

A row has its name and unit for people, its meaning, its possible values, and for the station its
limits, the reason for them and the next step where they do not hold.
"""

import csv
import math
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.resources import files
from typing import Any, NamedTuple

NBSP = "\xa0"  # no-break space


def counted(number: int, noun: str) -> str:
    """A number with its noun: `2 logs`."""
    return f"{number} {noun}{'s' * (number != 1)}"


def quoted(names: Sequence[str], most: int = 10) -> str:
    """Names in quotes: the first ones, and how many more there are.

    >>> quoted(["p", "v", "a"], 2)
    "'p', 'v' and 1 more"
    """
    more = f" and {len(names) - most} more" if len(names) > most else ""
    return ", ".join(map(repr, names[:most])) + more


def plus_minus(value: float, half: float) -> str:
    r"""A value with the half width of its interval, with three decimals, on one line.

    >>> plus_minus(0.38, 0.0236)
    '0.380\xa0±\xa00.024'
    """
    return f"{value:.3f}{NBSP}\N{PLUS-MINUS SIGN}{NBSP}{half:.3f}"


def signed_percent(share: float) -> str:
    r"""A change in whole percent with its sign; no sign where it rounds to nothing.

    >>> signed_percent(0.014), signed_percent(-0.003)
    ('+1\xa0%', '0\xa0%')
    """
    whole = round(100.0 * share)
    return f"{whole:+d}{NBSP}%" if whole else f"0{NBSP}%"


def range_words(low: str, high: str) -> str:
    """A range between two written numbers; an end that is empty is open.

    >>> range_words("1", "2"), range_words("1", ""), range_words("", "2"), range_words("", "")
    ('1 to 2', 'at least 1', 'at most 2', 'none')
    """
    if low and high:
        return low if low == high else f"{low} to {high}"
    return f"at least {low}" if low else f"at most {high}" if high else "none"


def finite(value: float | None) -> float | None:
    """A number for a file; None if it is unknown or not finite."""
    return None if value is None or not math.isfinite(value) else float(value)


class Ends(NamedTuple):
    """Limits of a metric; None where an end is open."""

    low: float | None = None
    high: float | None = None
    warn_low: float | None = None
    warn_high: float | None = None


_OPEN = Ends()


@dataclass(frozen=True)
class _Plain:
    """One row of `metrics.csv`; None where an end is open.

    ``scope``: "car" for the station, "stop" for a validation, else "". ``unit`` is the displayed
    one, or "", and ``factor`` converts from SI. ``step``: smallest relevant difference [SI], which
    gives the displayed decimals, or 0. Possible values are ``least`` to ``most``; ``cut`` stands
    for all larger ones.

    The station fails outside ``low`` to ``high`` and warns outside ``warn_low`` to ``warn_high``;
    ``judged`` is the place in its order, 0 if it is not judged. ``stop``: limits of `validate`, and
    default of the station.
    """

    name: str
    unit: str = ""
    factor: float = 1.0
    step: float = 0.0
    scope: str = ""
    least: float | None = None
    most: float | None = None
    cut: float | None = None
    judged: int = 0
    low: float | None = None
    high: float | None = None
    warn_low: float | None = None
    warn_high: float | None = None
    stop: Ends = _OPEN
    required: bool = False
    meaning: str = ""
    reason: str = ""
    action: str = ""

    @property
    def heading(self) -> str:
        """Name and unit: `Valid samples [%]`."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def value(self, value: float | None, digits: int = 4) -> str:
        """A value in the displayed unit, without that unit.

        >>> _Plain("Valid samples", "%", 100.0, 0.002).value(0.9516)
        '95.2'
        """
        if value is None or not math.isfinite(value):
            return "not known"
        shown = self.factor * value
        if not self.step:
            return f"{shown:.{digits}g}"
        places = max(0, -math.floor(math.log10(self.factor * self.step) + 1e-9))
        return f"{shown:z.{places}f}"

    def with_unit(self, value: float | None) -> str:
        """A value with its unit, `95.2 %`, unbroken."""
        text = self.value(value)
        if self.unit and text != "not known":
            text += f"{NBSP}{self.unit}"
        return text + " or more" * (value is not None and value == self.cut)

    def bounds(self, low: float | None, high: float | None) -> str:
        r"""A range in the displayed unit, not rounded to `step`.

        >>> _Plain("Valid samples", "%", 100.0, 0.01).bounds(0.125, None)
        'at least 12.5\xa0%'
        """
        least, most = ("" if x is None else f"{self.factor * x:.10g}" for x in (low, high))
        unit = f"{NBSP}{self.unit}" if self.unit and (least or most) else ""
        return range_words(least, most) + unit


def rows(file: str, package: str = "calib.base") -> list[dict[str, str]]:
    """The rows of a table in a package."""
    text = (files(package) / file).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


def listed(cell: str) -> tuple[str, ...]:
    """The texts of a cell that holds several."""
    return tuple(filter(None, cell.split("|")))


def _read(row: dict[str, str]) -> _Plain:
    texts = ("scope", "name", "unit", "meaning", "reason", "action")
    cells: dict[str, Any] = {
        name: row[name] if name in texts else float(row[name])
        for name in row
        if row[name] and name not in ("key", "judged", "required")
    }
    stop = Ends(**{end: cells.pop(f"stop_{end}", None) for end in Ends._fields})
    judged, required = int(row["judged"] or 0), row["required"] == "yes"
    return _Plain(**cells, stop=stop, judged=judged, required=required)


METRICS: dict[str, _Plain] = {row["key"]: _read(row) for row in rows("metrics.csv")}


def meanings(scope: str) -> dict[str, str]:
    """Keys and meanings of the metrics of a "car" or of a "stop", in their order."""
    return {key: one.meaning for key, one in METRICS.items() if one.scope == scope}


def bound(key: str, end: str, *, of_stop: bool = False) -> float:
    """A limit, by the name of its column."""
    return float(getattr(METRICS[key].stop if of_stop else METRICS[key], end))


def plain(key: str, unit: str = "1") -> _Plain:
    """The metric of a key; an unknown one is displayed by its key and ``unit``."""
    return METRICS.get(key) or _Plain(key, "" if unit == "1" else unit)

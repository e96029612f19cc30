"""Numbers and names as people read them, CSV files of a package, and the list of all metrics.

A metric is a number that judges a table or a stop. `metrics.csv` has a row for each metric. The
key of the row is the name of the metric in JSON files and limits files.
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
    return f"1 {noun}" if number == 1 else f"{number} {noun}s"


def quoted(names: Sequence[str], limit: int = 10) -> str:
    """The first ``limit`` names in quotes, and how many more there are.

    >>> quoted(["p", "v", "a"], 2)
    "'p', 'v' and 1 more"
    """
    more = f" and {len(names) - limit} more" if len(names) > limit else ""
    return ", ".join(map(repr, names[:limit])) + more


def plus_minus(value: float, half: float) -> str:
    r"""A value and the half width of its interval, with three decimals.

    >>> plus_minus(0.38, 0.0236)
    '0.380\xa0±\xa00.024'
    """
    return f"{value:.3f}{NBSP}\N{PLUS-MINUS SIGN}{NBSP}{half:.3f}"


def signed_percent(share: float) -> str:
    r"""A change in whole percent with its sign; no sign where it rounds to nothing.

    >>> signed_percent(0.014), signed_percent(-0.003)
    ('+1\xa0%', '0\xa0%')
    """
    rounded = round(100.0 * share)
    return f"{rounded:+d}{NBSP}%" if rounded else f"0{NBSP}%"


def without_exponent(value: float) -> str:
    """A number with three digits, as people write it.

    >>> without_exponent(0.05523), without_exponent(200000.0), without_exponent(5e-6)
    ('0.0552', '200000', '0.000005')
    """
    digits = f"{value:.3g}"
    return f"{float(digits):.12f}".rstrip("0").rstrip(".") if "e" in digits else digits


def range_words(low: str, high: str) -> str:
    """A range in words; its bounds are written numbers, or "" where there is no bound.

    >>> range_words("1", "2"), range_words("1", ""), range_words("", "2"), range_words("", "")
    ('1 to 2', 'at least 1', 'at most 2', 'none')
    """
    if low and high:
        return low if low == high else f"{low} to {high}"
    if low:
        return f"at least {low}"
    return f"at most {high}" if high else "none"


def finite_or_none(value: float | None) -> float | None:
    """A number for a JSON file: None if it is unknown or not finite."""
    return None if value is None or not math.isfinite(value) else float(value)


def rows(file: str, package: str = "calib.base") -> list[dict[str, str]]:
    """The rows of a CSV file in a package, each as texts by the name of the column."""
    text = (files(package) / file).read_text(encoding="utf-8")
    return list(csv.DictReader(text.splitlines()))


def texts_of(cell: str) -> tuple[str, ...]:
    """The texts in a cell of a CSV file, which "|" separates."""
    return tuple(text for text in cell.split("|") if text)


class MetricLimits(NamedTuple):
    """Limits of a metric, None where there is none.

    A value outside ``low`` to ``high`` fails, outside ``warn_low`` to ``warn_high`` it warns.
    """

    low: float | None = None
    high: float | None = None
    warn_low: float | None = None
    warn_high: float | None = None


_NO_LIMITS = MetricLimits()


@dataclass(frozen=True)
class Metric:
    """One row of `metrics.csv`."""

    name: str
    unit: str = ""  # as displayed
    factor: float = 1.0  # converts from SI to `unit`
    step: float = 0.0  # smallest relevant difference [SI], which gives the displayed decimals
    scope: str = ""  # "car" or "stop": whether it judges a car with its table, or a single stop
    cut: float = math.inf  # this value stands for all larger values [SI]
    judged: int = 0  # place in the station's order; 0 if the station does not judge the metric
    station: MetricLimits = _NO_LIMITS  # limits of `station` [SI]
    validate: MetricLimits = _NO_LIMITS  # of `validate`; of `station` where ``station`` has none
    required: bool = False  # whether an unknown value fails
    meaning: str = ""
    reason: str = ""  # why these limits
    action: str = ""  # next step for the user where a value is outside the limits

    @property
    def heading(self) -> str:
        """Name and unit: `Valid samples [%]`."""
        return f"{self.name} [{self.unit}]" if self.unit else self.name

    def value(self, value: float | None) -> str:
        """A value [SI] as a number of the displayed unit; four digits where `step` is 0.

        >>> Metric("Valid samples", "%", 100.0, 0.002).value(0.9516)
        '95.2'
        """
        if value is None or not math.isfinite(value):
            return "not known"
        displayed = self.factor * value
        if not self.step:
            return f"{displayed:.4g}"
        decimals = max(0, -math.floor(math.log10(self.factor * self.step) + 1e-9))
        return f"{displayed:z.{decimals}f}"

    def with_unit(self, value: float | None) -> str:
        """A value with its unit, `95.2 %`, without a line break between them."""
        text = self.value(value)
        if text == "not known":
            return text
        unit = f"{NBSP}{self.unit}" if self.unit else ""
        return f"{text}{unit} or more" if value == self.cut else text + unit

    def bounds(self, low: float | None, high: float | None) -> str:
        r"""A range with the displayed unit, not rounded to `step`.

        >>> Metric("Valid samples", "%", 100.0, 0.01).bounds(0.125, None)
        'at least 12.5\xa0%'
        """
        ends = ["" if x is None else f"{self.factor * x:.10g}" for x in (low, high)]
        unit = f"{NBSP}{self.unit}" if self.unit and any(ends) else ""
        return range_words(*ends) + unit


def _read(row: dict[str, str]) -> Metric:
    texts = ("scope", "name", "unit", "meaning", "reason", "action")
    cells: dict[str, Any] = {column: row[column] for column in texts}
    cells |= {column: float(row[column]) for column in ("factor", "step", "cut") if row[column]}
    for field, prefix in (("station", ""), ("validate", "stop_")):
        ends = [row[prefix + end] for end in MetricLimits._fields]
        cells[field] = MetricLimits(*(float(end) if end else None for end in ends))
    return Metric(**cells, judged=int(row["judged"] or 0), required=row["required"] == "yes")


METRICS: dict[str, Metric] = {row["key"]: _read(row) for row in rows("metrics.csv")}
"""All metrics by key, in the order of the file."""


def meanings(scope: str) -> dict[str, str]:
    """Keys and meanings of the metrics of a "car" or of a "stop", in their order."""
    return {key: metric.meaning for key, metric in METRICS.items() if metric.scope == scope}


def limit_of(key: str, end: str) -> float:
    """A limit of the station for a metric, by its name in `MetricLimits`, such as "warn_high"."""
    return float(getattr(METRICS[key].station, end))


def metric_of(key: str, unit: str = "1") -> Metric:
    """The metric of a key; for an unknown key, a metric with the key as its name and ``unit``."""
    if key in METRICS:
        return METRICS[key]
    return Metric(key, "" if unit == "1" else unit)

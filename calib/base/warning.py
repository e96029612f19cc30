"""Warnings about a run or a result, and the rules by which they are given, from `rules.csv`.

    run --figure--> Measured --rules of its code, for a purpose--> PlausibilityWarning

A figure is a function that measures one property of a run. A row of `rules.csv` is a rule: it says
in which range that value must lie, and whether a value outside refuses the run, makes its result
void, or gives a warning. A code may have several rows, for other purposes or consequences; an empty
cell there is that of the first row.
"""

import json
import math
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import asdict, dataclass, field
from types import SimpleNamespace
from typing import Any, NamedTuple

from calib.base.errors import not_finite
from calib.base.plain import metric_of, range_words, rows, texts_of, without_exponent
from calib.base.units import unit_suffix

REFUSE, VOID, WARN = "refuse", "void", "warn"
"""Consequences of a value outside the range: no result, a void result, a warning."""


class _Rule(NamedTuple):
    """A row of `rules.csv`: a value of ``code`` must lie from ``low`` to ``high``.

    ``figure`` measures the value, in ``unit``. A value within ``sigmas`` of its own standard
    deviations from zero breaks no rule. ``purposes`` are the commands that ask for the rule.
    ``needs`` is "vehicle", "logs", "table", "fit" or "". ``causes`` begin with the most likely one;
    ``causes_below`` are those of a value below the range, if they are others. ``entails`` names
    codes that follow from this one, so that they need no warning of their own.
    """

    code: str
    title: str
    figure: str
    unit: str
    purposes: tuple[str, ...]
    consequence: str
    needs: str
    low: float
    high: float
    sigmas: float
    causes: tuple[str, ...]
    causes_below: tuple[str, ...]
    do: str
    entails: tuple[str, ...]


def _read(row: dict[str, str], first: dict[str, str]) -> _Rule:
    cells: dict[str, Any] = {**first, **{name: cell for name, cell in row.items() if cell}}
    del cells["reason"]
    for name, default in (("low", -math.inf), ("high", math.inf), ("sigmas", 0.0)):
        cells[name] = float(cells[name] or default)
    for name in ("purposes", "entails"):
        cells[name] = tuple(cells[name].split())
    for name in ("causes", "causes_below"):
        cells[name] = texts_of(cells[name])
    return _Rule(**cells)


_ROWS = rows("rules.csv")
_FIRST_ROWS = {row["code"]: row for row in reversed(_ROWS)}
RULES = tuple(_read(row, _FIRST_ROWS[row["code"]]) for row in _ROWS)
"""All rules, in the order of the file."""

_BY_CODE: dict[str, list[_Rule]] = {}
for _rule in RULES:
    _BY_CODE.setdefault(_rule.code, []).append(_rule)
LIMITS = SimpleNamespace(
    **{row["name"]: json.loads(row["value"]) for row in rows("log_limits.csv")}
)
"""Further limits for logs, by name; `log_limits.csv` has their units and reasons."""

UNITS = {code: rules[0].unit for code, rules in _BY_CODE.items()}
"""Unit of the value of each code.

A code that measures nothing has the value 1. A metric beyond its limit gives a warning, too: its
code is the key of the metric, which has no unit here.
"""


@dataclass(frozen=True)
class PlausibilityWarning:
    """A warning.

    ``code`` is a code of `UNITS` or the key of a metric. ``log`` is the name of the log, table or
    vehicle. ``measured`` and ``expected`` are in the unit of the code; ``expected`` is the lower
    and the upper bound, None where there is none. ``causes`` begin with the most likely one. ``do``
    is the remedy. Raises NotFiniteError for a number that is not finite.
    """

    code: str
    log: str
    measured: float
    expected: tuple[float | None, float | None]
    causes: tuple[str, ...]
    do: str

    def __post_init__(self) -> None:
        for number in (self.measured, *self.expected):
            if number is not None and not math.isfinite(number):
                raise not_finite(self.code, self.log)

    def __str__(self) -> str:
        return f"{self.log}: {self.text}"

    @property
    def text(self) -> str:
        """The warning without the log, and with the most likely cause alone."""
        text = f"{self.title} ({self.code})"
        is_yes_or_no = UNITS.get(self.code) == "1" and self.expected == (0.0, 0.0)
        if not is_yes_or_no:
            text = f"{text} is {self.amount}, expected {self.bounds}"
        return "; ".join([text, *(f"likely {cause}" for cause in self.causes[:1]), self.do])

    @property
    def title(self) -> str:
        """Words for the quantity that was measured: those of its rule, or of its metric."""
        rules = _BY_CODE.get(self.code)
        title = rules[0].title if rules else ""
        return title or metric_of(self.code).name

    @property
    def amount(self) -> str:
        """The measured value with its unit."""
        return f"{without_exponent(self.measured)}{unit_suffix(UNITS.get(self.code, '1'))}"

    @property
    def bounds(self) -> str:
        """The expected range in words, with its unit."""
        ends = ("" if end is None else without_exponent(end) for end in self.expected)
        return range_words(*ends) + unit_suffix(UNITS.get(self.code, "1"))


@dataclass(frozen=True)
class Measured:
    """A measured value of a ``code`` with its standard deviation ``sigma``.

    ``value`` is in the unit in which `rules.csv` gives the range. ``to_display``, an increasing
    function, converts it to the unit of the warning. ``words`` fill the placeholders in the causes
    and the remedy of the rule, such as {channel}.
    """

    code: str
    value: float
    sigma: float = 0.0
    to_display: Callable[[float], float] = float
    words: Mapping[str, object] = field(default_factory=dict)


def relative(code: str, value: float, usual: float) -> Measured:
    """Return the change of a value relative to its ``usual`` value [1]; people see the value."""
    return Measured(code, value / usual - 1.0, to_display=lambda change: (1.0 + change) * usual)


def rule_warnings(
    log: str,
    measured: Iterable[Measured],
    purpose: str | None = None,
    consequences: Collection[str] = (WARN,),
) -> tuple[PlausibilityWarning, ...]:
    """Return a warning for each measured value that breaks a rule.

    Only rules of the ``purpose`` (None: of any) with one of the ``consequences`` count. Of several
    broken rules of a code, the first one counts: it is the gravest.
    """
    warnings = []
    for value in measured:
        for rule in _BY_CODE[value.code]:
            counts = rule.consequence in consequences and purpose in (None, *rule.purposes)
            low, high = _range(rule, value.sigma)
            if counts and (value.value < low or value.value > high):
                warnings.append(_warning(rule, log, value, low, high))
                break
    return tuple(warnings)


def _range(rule: _Rule, sigma: float) -> tuple[float, float]:
    """The range of a rule for a value with the standard deviation ``sigma``."""
    margin = rule.sigmas * sigma
    if margin == 0.0:
        return rule.low, rule.high
    return min(rule.low, -margin), max(rule.high, margin)


def _warning(
    rule: _Rule, log: str, measured: Measured, low: float, high: float
) -> PlausibilityWarning:
    lower, upper = (measured.to_display(x) if math.isfinite(x) else None for x in (low, high))
    is_below = measured.value < low and bool(rule.causes_below)
    cells = rule.causes_below if is_below else rule.causes
    filled = [cell.format(**measured.words) for cell in cells]
    causes = tuple(cause for cell in filled for cause in texts_of(cell))
    do = rule.do.format(**measured.words)
    value = measured.to_display(measured.value)
    return PlausibilityWarning(measured.code, log, value, (lower, upper), causes, do)


def unexplained(
    warnings: Iterable[PlausibilityWarning], others: Iterable[PlausibilityWarning] = ()
) -> tuple[PlausibilityWarning, ...]:
    """Return the warnings that follow from no other warning, in the order of the rules.

    For example, locked wheels that follow from a wrong unit are left out. ``others`` are warnings
    that may explain some, but are not returned.
    """
    candidates, explained = tuple(warnings), set[str]()
    for warning in (*candidates, *others):
        first = _BY_CODE[warning.code][0]
        if not first.low <= warning.measured <= first.high:
            explained.update(first.entails)
    places = {code: place for place, code in enumerate(_BY_CODE)}
    remaining = [warning for warning in candidates if warning.code not in explained]
    return tuple(sorted(remaining, key=lambda warning: places[warning.code]))


def bounds_of(code: str) -> tuple[float, float]:
    """Range of the first rule of a code."""
    first = _BY_CODE[code][0]
    return first.low, first.high


def to_dict(warning: PlausibilityWarning) -> dict[str, Any]:
    """Return a warning as JSON types; a missing bound is null."""
    return {**asdict(warning), "expected": [*warning.expected], "causes": [*warning.causes]}

"""Warnings about a run or a result, and the rules by which they are given, from `rules.csv`.

    run --figure--> Measured --rules of its code, for a purpose--> PlausibilityWarning

A figure is a function that measures properties of a run. Each property has a code, such as
`a_x_scale`. A row of `rules.csv` is a rule: it says in which range the value of a code must lie,
and whether a value outside refuses the run, makes its result void, or gives a warning. A code may
have several rows, for other purposes or consequences. In the later rows of a code, an empty cell
stands for that of the first row.
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
    """A row of `rules.csv`: a value of ``code`` must lie from ``low`` to ``high``."""

    code: str
    title: str  # words for the measured quantity
    figure: str  # name of the function that measures it
    unit: str
    purposes: tuple[str, ...]  # commands that ask for the rule
    consequence: str
    needs: str  # what must be known for it: "vehicle", "logs", "table", "fit" or ""
    low: float
    high: float
    sigmas: float  # a value within so many of its standard deviations from zero breaks no rule
    causes: tuple[str, ...]  # the most likely one first
    causes_below: tuple[str, ...]  # those of a value below the range; empty: `causes`
    do: str  # remedy
    entails: tuple[str, ...]  # codes that follow from this code and need no warning of their own


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


_FIRST_ROWS: dict[str, dict[str, str]] = {}  # the first row of each code
RULES = tuple(_read(row, _FIRST_ROWS.setdefault(row["code"], row)) for row in rows("rules.csv"))
"""All rules, in the order of the file."""

_BY_CODE: dict[str, list[_Rule]] = {}
for _rule in RULES:
    _BY_CODE.setdefault(_rule.code, []).append(_rule)
UNITS = {code: rules[0].unit for code, rules in _BY_CODE.items()}
"""Unit of the value of each code; a code that only says yes has the unit and the value 1."""

LIMITS = SimpleNamespace(
    **{row["name"]: json.loads(row["value"]) for row in rows("log_limits.csv")}
)
"""Further limits for logs, by name; `log_limits.csv` has their units and reasons."""


@dataclass(frozen=True)
class PlausibilityWarning:
    """A warning in its public shape. Raises NotFiniteError for a number that is not finite."""

    code: str  # of a rule, or the key of a metric that is outside its limits
    log: str  # name of the log, table or vehicle
    measured: float  # in the unit of the code
    expected: tuple[float | None, float | None]  # lower and upper bound, None where there is none
    causes: tuple[str, ...]  # the most likely one first
    do: str  # remedy

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
        measures_nothing = UNITS.get(self.code) == "1" and self.expected == (0.0, 0.0)
        if not measures_nothing:
            text += f" is {self.amount}, expected {self.bounds}"
        if self.causes:
            text += f"; likely {self.causes[0]}"
        return f"{text}; {self.do}"

    @property
    def title(self) -> str:
        """Words for the measured quantity, from the rule or the metric of the code."""
        title = _BY_CODE[self.code][0].title if self.code in _BY_CODE else ""
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
    """A measured value of a ``code`` with its standard deviation ``sigma``."""

    code: str
    value: float  # in the unit in which `rules.csv` gives the range
    sigma: float = 0.0
    to_display: Callable[[float], float] = float  # increasing function to the unit of the warning
    words: Mapping[str, object] = field(default_factory=dict)
    """Texts for the placeholders in the causes and the remedy of the rule, such as {channel}."""


def relative(code: str, value: float, usual: float) -> Measured:
    """Return a value that is judged by value/usual - 1 [1], and shown in its own unit."""
    return Measured(code, value / usual - 1.0, to_display=lambda change: (1.0 + change) * usual)


def rule_warnings(
    log: str,
    values: Iterable[Measured],
    purpose: str | None = None,
    consequences: Collection[str] = (WARN,),
) -> tuple[PlausibilityWarning, ...]:
    """Return a warning for each value that breaks a rule.

    Only rules of the ``purpose`` (None: of any) with one of the ``consequences`` are applied. Of
    several broken rules of a code, the first and gravest one gives the warning.
    """
    warnings = []
    for measured in values:
        for rule in _BY_CODE[measured.code]:
            is_asked = purpose is None or purpose in rule.purposes
            applies = is_asked and rule.consequence in consequences
            low, high, margin = rule.low, rule.high, rule.sigmas * measured.sigma
            if margin != 0.0:
                low, high = min(low, -margin), max(high, margin)
            if applies and (measured.value < low or measured.value > high):
                warnings.append(_warning(rule, log, measured, low, high))
                break
    return tuple(warnings)


def _warning(
    rule: _Rule, log: str, measured: Measured, low: float, high: float
) -> PlausibilityWarning:
    lower, upper = (measured.to_display(x) if math.isfinite(x) else None for x in (low, high))
    causes = rule.causes
    if measured.value < low and rule.causes_below:
        causes = rule.causes_below
    # the text of a placeholder may hold several causes between "|", or none
    filled = texts_of("|".join(causes).format(**measured.words))
    do, value = rule.do.format(**measured.words), measured.to_display(measured.value)
    return PlausibilityWarning(rule.code, log, value, (lower, upper), filled, do)


def unexplained(
    warnings: Iterable[PlausibilityWarning], others: Iterable[PlausibilityWarning] = ()
) -> tuple[PlausibilityWarning, ...]:
    """Return the warnings that follow from no other warning, in the order of the rules.

    For example, locked wheels that follow from a wrong unit are left out. ``others`` are further
    warnings from which some may follow; they are not returned. A code entails others only where
    its value breaks its first rule, the gravest. No such code is converted to another unit.
    """
    candidates, explained = tuple(warnings), set[str]()
    for warning in (*candidates, *others):
        first = _BY_CODE[warning.code][0]
        if not first.low <= warning.measured <= first.high:
            explained.update(first.entails)
    codes = list(_BY_CODE)
    remaining = [warning for warning in candidates if warning.code not in explained]
    return tuple(sorted(remaining, key=lambda warning: codes.index(warning.code)))


def bounds_of(code: str) -> tuple[float, float]:
    """Range of the first rule of a code."""
    first = _BY_CODE[code][0]
    return first.low, first.high


def to_dict(warning: PlausibilityWarning) -> dict[str, Any]:
    """Return a warning as JSON types; a missing bound is null."""
    return {**asdict(warning), "expected": [*warning.expected], "causes": [*warning.causes]}

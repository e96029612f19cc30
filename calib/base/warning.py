"""Warnings on a run or a result, and the list of rules: `rules.csv`.

figure of the run --Measured--> rows of its code for a purpose --outside the range--> warning

A row refuses the run, makes its result void, or warns. Further rows of a code, for other purposes
or consequences, inherit empty cells from the first one.
"""

import json
import math
from collections.abc import Callable, Collection, Iterable, Mapping
from dataclasses import asdict, dataclass, field
from types import SimpleNamespace
from typing import Any, NamedTuple

from calib.base.errors import not_finite
from calib.base.plain import listed, plain, range_words, rows
from calib.base.units import behind

REFUSE, VOID, WARN = "refuse", "void", "warn"
"""Consequences of a value outside the range: no result, a void result, a warning."""


class _Rule(NamedTuple):
    """A row: the ``code`` that the ``figure`` yields must lie from ``low`` to ``high``.

    The range includes zero +- ``sure`` sigmas. ``needs`` a vehicle, other logs, a table, a fit or
    "". ``causes`` the most likely first, ``below`` those of a value below the range. ``makes``:
    codes that follow from it.
    """

    code: str
    means: str
    figure: str
    unit: str
    purposes: tuple[str, ...]
    does: str
    needs: str
    low: float
    high: float
    sure: float
    causes: tuple[str, ...]
    below: tuple[str, ...]
    do: str
    makes: tuple[str, ...]


def _read(row: dict[str, str], first: dict[str, str]) -> _Rule:
    cells: dict[str, Any] = {**first, **{name: cell for name, cell in row.items() if cell}}
    del cells["reason"]
    for name, default in (("low", -math.inf), ("high", math.inf), ("sure", 0.0)):
        cells[name] = float(cells[name] or default)
    for name in ("purposes", "makes"):
        cells[name] = tuple(cells[name].split())
    return _Rule(**cells | {name: listed(cells[name]) for name in ("causes", "below")})


_ROWS = rows("rules.csv")
_FIRST = {row["code"]: row for row in reversed(_ROWS)}
RULES = tuple(_read(row, _FIRST[row["code"]]) for row in _ROWS)
_OF: dict[str, list[_Rule]] = {}
for _rule in RULES:
    _OF.setdefault(_rule.code, []).append(_rule)
LIMITS = SimpleNamespace(
    **{row["name"]: json.loads(row["value"]) for row in rows("log_limits.csv")}
)
"""Further limits for logs, each with its unit and its reason."""

UNITS = {code: of_code[0].unit for code, of_code in _OF.items()}
"""Unit of each code. A code that measures nothing has the value 1; a metric beyond its limit has
its own name as code, without unit."""


@dataclass(frozen=True)
class PlausibilityWarning:
    """One warning.

    ``code`` of `UNITS`, or a metric beyond its limit; ``log`` name of the log, table or vehicle;
    ``measured`` and ``expected`` (low, high; None without a bound) in the unit of the code;
    ``causes`` the most likely first; ``do`` the remedy. Raises NotFiniteError.
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
        if (UNITS.get(self.code), self.measured, self.expected) != ("1", 1.0, (0.0, 0.0)):
            text = f"{text}: {self.amount}, expected {self.bounds}"
        return "; ".join([text, *(f"likely {cause}" for cause in self.causes[:1]), self.do])

    @property
    def title(self) -> str:
        """What was measured, in words."""
        of_code = _OF.get(self.code)
        return (of_code[0].means if of_code else "") or plain(self.code).name

    @property
    def amount(self) -> str:
        """What was measured, with its unit."""
        return f"{self.measured:.3g}{behind(UNITS.get(self.code, '1'))}"

    @property
    def bounds(self) -> str:
        """The expected range in words."""
        return range_words(*("" if end is None else f"{end:.3g}" for end in self.expected))


@dataclass(frozen=True)
class Measured:
    """Value and sigma of a code of `rules.csv`, in the scale of its range.

    ``shown`` converts to the scale of the warning, rising; ``words`` are put into its causes.
    """

    code: str
    value: float
    sigma: float = 0.0
    shown: Callable[[float], float] = float
    words: Mapping[str, object] = field(default_factory=dict)


def relative(code: str, value: float, usual: float) -> Measured:
    """A value whose row bounds its relative change from the ``usual`` one [1]."""
    return Measured(code, value / usual - 1.0, shown=lambda change: (1.0 + change) * usual)


def judged(
    log: str,
    measured: Iterable[Measured],
    purpose: str | None = None,
    does: Collection[str] = (WARN,),
) -> tuple[PlausibilityWarning, ...]:
    """Warnings of the rules of a ``purpose``, or of all, with one of the consequences ``does``.

    The gravest row of a code comes first, and alone counts.
    """
    warnings = []
    for m in measured:
        for rule in _OF[m.code]:
            low, high = rule.low, rule.high
            if sure := rule.sure * m.sigma:
                low, high = min(low, -sure), max(high, sure)
            outside = m.value < low or m.value > high
            if outside and rule.does in does and purpose in (None, *rule.purposes):
                warnings.append(_warned(rule, log, m, low, high))
                break
    return tuple(warnings)


def _warned(rule: _Rule, log: str, m: Measured, low: float, high: float) -> PlausibilityWarning:
    shown = [m.shown(end) if math.isfinite(end) else None for end in (low, high)]
    cells = rule.below if m.value < low and rule.below else rule.causes
    causes = tuple(one for cell in cells for one in listed(cell.format(**m.words)))
    do = rule.do.format(**m.words)
    return PlausibilityWarning(m.code, log, m.shown(m.value), (shown[0], shown[1]), causes, do)


def unexplained(
    warnings: Iterable[PlausibilityWarning], beside: Iterable[PlausibilityWarning] = ()
) -> tuple[PlausibilityWarning, ...]:
    """The warnings that follow from no other one, nor from one ``beside`` them, in order of rules.

    For example, locked wheels that follow from a wrong unit are left out.
    """
    every, explained = tuple(warnings), set[str]()
    for one in (*every, *beside):
        first = _OF[one.code][0]
        if not first.low <= one.measured <= first.high:
            explained |= {*first.makes}
    unexplained_ones = [one for one in every if one.code not in explained]
    return tuple(sorted(unexplained_ones, key=lambda one: [*_OF].index(one.code)))


def bounds_of(code: str) -> tuple[float, float]:
    """Range of the first row of a code."""
    return _OF[code][0].low, _OF[code][0].high


def to_dict(warning: PlausibilityWarning) -> dict[str, Any]:
    """A warning as JSON types; a missing bound is null."""
    return {**asdict(warning), "expected": [*warning.expected], "causes": [*warning.causes]}

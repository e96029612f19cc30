"""One shape for a warning: what speaks against a result although it is given."""

import math
from collections.abc import Callable, Iterable, Mapping
from dataclasses import asdict, dataclass, field
from typing import Any

from calib.base.errors import not_finite
from calib.base.plain import listed, plain, rows

_ROWS = {row["code"]: row for row in rows("warnings.csv")}
UNITS = {code: row["unit"] for code, row in _ROWS.items()}
"""The codes with the unit of what they measure, first those of a fit or an estimate, then those of
a log by itself, then those of a vehicle file, whose ``log`` is the name of the vehicle; 1 of a code
that measures nothing else says that it is so. A metric past its limit has its own name as code, and
is a number without unit."""


@dataclass(frozen=True)
class PlausibilityWarning:
    """One warning.

    ``code`` of `UNITS`, or the metric whose limit is not held; ``log`` its name, or that of the
    table; ``measured`` and ``expected`` (low, high; None where there is no bound) in the unit of
    the code; ``causes`` the most likely first; ``do`` what to do.

    Raises NotFiniteError for a number that is not finite: it would speak against something else.
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
        """The warning as a sentence, without the log, and with the most likely cause alone."""
        name = plain(self.code).name
        named = self.code if name == self.code else f"{name} ({self.code})"
        told = f"{named}: {self.amount}, expected {self.bounds}"
        return "; ".join([told, *(f"likely {cause}" for cause in self.causes[:1]), self.do])

    @property
    def amount(self) -> str:
        """What was measured, with its unit."""
        unit = UNITS.get(self.code, "1")
        return f"{self.measured:.3g}" + ("" if unit == "1" else f" {unit}")

    @property
    def bounds(self) -> str:
        """The expected range in words."""
        low, high = self.expected
        if low is None:
            return f"at most {high:.3g}"
        if high is None or low == high:
            return f"{low:.3g}" if low == high else f"at least {low:.3g}"
        return f"{low:.3g} to {high:.3g}"


def warning(
    code: str,
    log: str,
    measured: float,
    expected: tuple[float | None, float | None] = (0.0, 0.0),
    **words: object,
) -> PlausibilityWarning:
    """A warning whose causes and next step are those of `warnings.csv`, with these ``words``.

    What is below its range may have causes of its own.
    """
    row = _ROWS[code]
    low = -math.inf if expected[0] is None else expected[0]
    told = row["below"] if measured < low and row["below"] else row["causes"]
    causes = tuple(cause.format(**words) for cause in listed(told))
    return PlausibilityWarning(code, log, measured, expected, causes, row["do"].format(**words))


@dataclass(frozen=True)
class Measured:
    """What a run says of a code of `warnings.csv`, in the measure of the range of its row.

    ``value`` with its ``sigma``; ``shown`` that measure as the warning tells it, rising; ``words``
    for its causes.
    """

    code: str
    value: float
    sigma: float = 0.0
    shown: Callable[[float], float] = float
    words: Mapping[str, object] = field(default_factory=dict)


def relative(code: str, value: float, usual: float) -> Measured:
    """A value of which the row bounds the change from what is ``usual`` [1]."""
    return Measured(code, value / usual - 1.0, shown=lambda change: (1.0 + change) * usual)


def judged(log: str, measured: Iterable[Measured]) -> tuple[PlausibilityWarning, ...]:
    """A warning of each that lies outside the range of its row.

    The range is no narrower than zero give or take ``sure`` of the sigmas.
    """
    return tuple(one for m in measured if (one := _warned(log, m)) is not None)


def _warned(log: str, m: Measured) -> PlausibilityWarning | None:
    row = _ROWS[m.code]
    low, high = float(row["low"] or -math.inf), float(row["high"] or math.inf)
    if row["sure"]:
        sure = float(row["sure"]) * m.sigma
        low, high = min(low, -sure), max(high, sure)
    if not (m.value < low or m.value > high):
        return None
    ends = [m.shown(end) if math.isfinite(end) else None for end in (low, high)]
    return warning(m.code, log, m.shown(m.value), (ends[0], ends[1]), **m.words)


def to_dict(warning: PlausibilityWarning) -> dict[str, Any]:
    """A warning as JSON types; a bound that is not there is null."""
    return {**asdict(warning), "expected": [*warning.expected], "causes": [*warning.causes]}

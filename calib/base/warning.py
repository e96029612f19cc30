"""One shape for a warning: what speaks against a result although it is given."""

import math
from dataclasses import asdict, dataclass
from typing import Any

from calib.base.errors import not_finite
from calib.base.plain import listed, rows

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
        """The warning as a sentence, without the log."""
        return (
            f"{self.code} is {self.amount}, expected {self.bounds}; "
            f"likely {', or '.join(self.causes)}; {self.do}"
        )

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
    """A warning whose causes and next step are those of `warnings.csv`, with these ``words``."""
    row = _ROWS[code]
    causes = tuple(cause.format(**words) for cause in listed(row["causes"]))
    return PlausibilityWarning(code, log, measured, expected, causes, row["do"].format(**words))


def to_dict(warning: PlausibilityWarning) -> dict[str, Any]:
    """A warning as JSON types; a bound that is not there is null."""
    return {**asdict(warning), "expected": [*warning.expected], "causes": [*warning.causes]}

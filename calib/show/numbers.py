"""Numbers and names as people read them, with bar, km/h, % and so on in place of SI units."""

import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from calib.base.plain import NBSP

if TYPE_CHECKING:
    from calib.diagnosis.diagnosis import ParameterEstimate

_PRINTED = {
    "Pa": ("bar", 1e-5),
    "m/s": ("km/h", 3.6),
    "1/Pa": ("%/bar", 1e7),
    "s/m": ("%/(km/h)", 100.0 / 3.6),
    "1/K": ("%/K", 100.0),
    "rad": ("deg", 180.0 / math.pi),
    "J": ("kJ", 1e-3),
    "W": ("kW", 1e-3),
    "1": ("", 1.0),
}
"""Printed unit of an SI unit, and the factor to it; other units are printed unchanged."""

_UNIT = r"%|sigma|degC?|rad/s|bar|[cmukM]?(?:g|m|s|Pa|Hz|N|J|W)(?:[/*^]\w+)*"
_BEFORE_UNIT = re.compile(rf"(?<=\d) (?=(?:{_UNIT})(?![\w*^]))")
"""Pattern of a unit, and of the space between a number and its unit."""
_IN_NEWTON_METRES = re.compile(r"\b(k?N) (?=m\b)")
"""Pattern of the N and the space of `N m`."""


def unbroken(text: str) -> str:
    """Return a text with no-break spaces between numbers and units; a command is not changed."""
    if text.startswith("brake-cal "):
        return text
    text = _IN_NEWTON_METRES.sub(rf"\1{NBSP}", text.replace(" ± ", f"{NBSP}±{NBSP}"))
    return _BEFORE_UNIT.sub(NBSP, text)


def spaced(name: str) -> str:
    """Return a name with spaces in place of underscores."""
    return name.replace("_", " ")


def listed(names: Sequence[str], last: str = "and") -> str:
    """Return names as `a, b and c`, with the word ``last`` before the last name."""
    *others, final = [spaced(name) for name in names]
    return f"{', '.join(others)} {last} {final}" if others else final


def to_printed(value: float, unit: str) -> float:
    """Return a ``value`` in the SI ``unit`` converted to its printed unit."""
    return value * _PRINTED.get(unit, (unit, 1.0))[1]


def with_unit(text: str, unit: str) -> str:
    """Return a text followed by the printed unit of the SI ``unit``."""
    return f"{text} {_PRINTED.get(unit, (unit, 1.0))[0]}".rstrip()


def number(value: float, step: float) -> str:
    """Return a value as text, rounded to the second significant digit of ``step``.

    ``step`` is in the unit of the value; 0 stands for a thousandth of the value.
    """
    if not math.isfinite(value) or not math.isfinite(step):
        return "not known"
    if step == 0.0:
        step = 1e-3 * abs(value) if value else 1.0
    decimals = max(0, 1 - math.floor(math.log10(step)))
    return f"{value:z.{decimals}f}"


def estimate(parameter: "ParameterEstimate") -> tuple[str, str]:
    """Return a parameter with its unit, and its 95 % interval in the same unit, as texts."""
    value, low, high = (to_printed(x, parameter.unit) for x in (parameter.value, *parameter.ci95))
    half = 0.5 * (high - low)
    interval = f"{number(low, half)} to {number(high, half)}"
    return with_unit(number(value, half), parameter.unit), interval


def span(ends: tuple[float, float], unit: str) -> str:
    """Return a range in the SI ``unit`` as text: `20 to 29 bar`; a narrow range has a decimal."""
    low, high = (to_printed(end, unit) for end in ends)
    decimals = 0 if high - low >= 2.0 else 1
    first, last = f"{low:z.{decimals}f}", f"{high:z.{decimals}f}"
    return with_unit(first if first == last else f"{first} to {last}", unit)

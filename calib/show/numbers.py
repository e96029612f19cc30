"""Numbers and names as people read them: SI inside, here bar, km/h and degC."""

import math
import re
from collections.abc import Sequence
from typing import TYPE_CHECKING

from calib.base.plain import NBSP

if TYPE_CHECKING:
    from calib.diagnosis.diagnosis import ParameterEstimate

_SHOWN = {
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
"""SI unit to the unit that is printed, and the factor; other units are printed unchanged."""

_UNIT = r"%|sigma|degC?|rad/s|bar|[cmukM]?(?:g|m|s|Pa|Hz|N|J|W)(?:[/*^]\w+)*"
_BEFORE_UNIT = re.compile(rf"(?<=\d) (?=(?:{_UNIT})(?![\w*^]))")
_METRES = re.compile(r"\b(k?N) (?=m\b)")


def whole(text: str) -> str:
    """The text with no-break spaces between numbers and units; a command stays as it is."""
    if text.startswith("brake-cal "):
        return text
    return _BEFORE_UNIT.sub(NBSP, _METRES.sub(rf"\1{NBSP}", text.replace(" ± ", f"{NBSP}±{NBSP}")))


def spaced(name: str) -> str:
    """A name with spaces for underscores."""
    return name.replace("_", " ")


def listed(names: Sequence[str], last: str = "and") -> str:
    """Names as a list in words: `a, b and c`."""
    words = [spaced(name) for name in names]
    return words[0] if len(words) == 1 else f"{', '.join(words[:-1])} {last} {words[-1]}"


def in_shown(value: float, unit: str) -> float:
    """A value [SI ``unit``] in the unit that is printed."""
    return value * _SHOWN.get(unit, (unit, 1.0))[1]


def with_unit(text: str, unit: str) -> str:
    """A text with the printed unit of a quantity [SI ``unit``]."""
    return f"{text} {_SHOWN.get(unit, (unit, 1.0))[0]}".rstrip()


def number(value: float, step: float) -> str:
    """A value to the second digit of ``step``, such as the half width of its interval."""
    if not math.isfinite(value) or not math.isfinite(step):
        return "not known"
    exponent = math.floor(math.log10(step or 1e-3 * abs(value) or 1.0))
    return f"{value:z.{max(0, 1 - exponent)}f}"


def estimate(parameter: "ParameterEstimate") -> tuple[str, str]:
    """A parameter with its unit, and its 95 % interval in the same."""
    value, low, high = (in_shown(x, parameter.unit) for x in (parameter.value, *parameter.ci95))
    half = 0.5 * (high - low)
    interval = f"{number(low, half)} to {number(high, half)}"
    return with_unit(number(value, half), parameter.unit), interval


def span(ends: tuple[float, float], unit: str) -> str:
    """A range [SI ``unit``] as it is printed, to three digits at most: `20 to 29 bar`."""
    low, high = (in_shown(end, unit) for end in ends)
    digits = 0 if high - low >= 2.0 else 1
    text = f"{low:z.{digits}f}", f"{high:z.{digits}f}"
    return with_unit(text[0] if text[0] == text[1] else f"{text[0]} to {text[1]}", unit)

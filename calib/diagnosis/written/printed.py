"""Numbers of a diagnosis as they are printed: SI inside, here bar, km/h and degC."""

import math

from calib.diagnosis.diagnose import ParameterEstimate

SHOWN = {
    "Pa": ("bar", 1e-5),
    "m/s": ("km/h", 3.6),
    "1/Pa": ("%/bar", 1e7),
    "s/m": ("%/(km/h)", 100.0 / 3.6),
    "1/K": ("%/K", 100.0),
    "rad": ("deg", 180.0 / math.pi),
    "J": ("kJ", 1e-3),
    "W": ("kW", 1e-3),
    "s": ("ms", 1e3),
    "1": ("", 1.0),
}
"""SI unit to the unit that is printed, and the factor; other units are printed unchanged."""


def in_shown(value: float, unit: str) -> float:
    """A value [SI ``unit``] in the unit that is printed."""
    return value * SHOWN.get(unit, (unit, 1.0))[1]


def unit_shown(unit: str) -> str:
    """The unit that is printed for an SI unit; nothing for a plain number."""
    return SHOWN.get(unit, (unit, 1.0))[0]


def number(value: float, step: float) -> str:
    """A value rounded to the second digit of ``step``, such as the half width of its interval."""
    if not math.isfinite(value) or not math.isfinite(step):
        return "not known"
    if step <= 0.0:
        return f"{value:.4g}"
    first = math.floor(math.log10(step))
    if first < -4 and abs(value) < 1e-2:
        digits = max(0, math.floor(math.log10(max(abs(value), step))) - first + 1)
        return f"{value:.{digits}e}"
    return _fixed(value, max(0, 1 - first))


def _fixed(value: float, digits: int) -> str:
    """A value with so many digits behind the point, without a sign before zero."""
    text = f"{value:.{digits}f}"
    return text.removeprefix("-") if float(text) == 0.0 else text


def percent(share: float) -> str:
    """A share [1] in whole percent, without a sign before zero."""
    return f"{round(100.0 * share):d} %"


def value_of(found: ParameterEstimate) -> str:
    """The value of a parameter with its unit."""
    return with_unit(number(_shown(found, found.value), _half(found)), found.unit)


def interval_of(found: ParameterEstimate) -> str:
    """The 95 % interval of a parameter, in the unit of `value_of`."""
    low, high = (number(_shown(found, end), _half(found)) for end in found.ci95)
    return f"{low} to {high}"


def _shown(found: ParameterEstimate, value: float) -> float:
    return in_shown(value, found.unit)


def _half(found: ParameterEstimate) -> float:
    low, high = found.ci95
    return 0.5 * (in_shown(high, found.unit) - in_shown(low, found.unit))


def with_unit(text: str, unit: str) -> str:
    """A number with the unit that is printed; a plain number alone."""
    return f"{text} {unit_shown(unit)}".rstrip()


def span(ends: tuple[float, float], unit: str) -> str:
    """A range [SI ``unit``] as it is printed, to three digits at most: `20 to 29 bar`."""
    low, high = (in_shown(end, unit) for end in ends)
    digits = 0 if high - low >= 2.0 else 1
    text = _fixed(low, digits), _fixed(high, digits)
    return with_unit(text[0] if text[0] == text[1] else f"{text[0]} to {text[1]}", unit)

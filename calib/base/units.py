"""Written units and their conversion to SI, from `units.csv`.

A unit is accepted only for its own quantity: ``g`` is standard gravity where an acceleration is
expected, and an error where a mass is expected. ``Hz`` of a wheel speed is revolutions per second.
"""

from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from calib.base.plain import rows

Number = TypeVar("Number", float, NDArray[np.float64])


class UnknownUnit(ValueError):
    """A unit is not in the list, or belongs to another quantity."""


class Unit(NamedTuple):
    """A unit: SI value = written value * ``scale`` / ``per`` + ``offset``.

    For a factor below 1, ``per`` is its inverse: 28.84 / 1e4 is rounded less than 28.84 * 1e-4.
    """

    scale: float = 1.0
    per: float = 1.0
    offset: float = 0.0


BAR = 1e5  # [Pa]

QUANTITIES: dict[str, tuple[str, dict[str, Unit]]] = {}
"""By SI unit: the name of the quantity, and the conversions of its units by their names."""
_SPELLINGS: dict[str, str] = {}  # the name of a unit by its other spellings
for _row in rows("units.csv"):
    _numbers = {name: float(_row[name]) for name in ("scale", "per", "offset") if _row[name]}
    _, _units = QUANTITIES.setdefault(_row["si"], (_row["quantity"], {}))
    _units[_row["unit"]] = Unit(**_numbers)
    _SPELLINGS |= dict.fromkeys(_row["spellings"].split(), _row["unit"])

_SIGNS = str.maketrans({"²": "^2", "·": "*", "⋅": "*", "×": "*", " ": None})


def spelling(unit: str) -> str:
    """Return a unit as `units.csv` spells it: ``m/s²`` becomes ``m/s^2``."""
    text = unit.strip().replace("N.m", "N*m").replace("**", "^")
    text = text.replace("⁻²", "^-2").replace("⁻¹", "^-1").translate(_SIGNS)
    return _SPELLINGS.get(text, text)


def unit_of(unit: str, si: str) -> Unit:
    """Return the conversion of a written unit to the SI unit ``si``. Raises `UnknownUnit`."""
    quantity, units = QUANTITIES[si]
    spelt = spelling(unit)
    if spelt in units:
        return units[spelt]
    message = f"unknown unit {unit!r} for {quantity}"
    for other_quantity, other_units in QUANTITIES.values():
        if spelt in other_units:
            message = f"unit {unit!r} is a unit of {other_quantity}, not of {quantity}"
            break
    raise UnknownUnit(f"{message}; known: {', '.join(units)}")


def unit_suffix(unit: str) -> str:
    """Return what follows a number: a space and the unit, or "" for the unit "1"."""
    return "" if unit == "1" else f" {unit}"


def si_of(unit: str) -> str:
    """Return the SI unit for a written unit: ``"m^2"`` for ``"cm^2"``. Raises `UnknownUnit`."""
    spelt = spelling(unit)
    for si, (_, units) in QUANTITIES.items():
        if spelt in units:
            return si
    names = sorted({name for _, units in QUANTITIES.values() for name in units})
    raise UnknownUnit(f"unknown unit {unit!r}; known: {', '.join(names)}")


def to_si(values: Number, unit: str, si: str) -> Number:
    """Convert ``values``, any shape, from a written ``unit`` to the SI unit ``si``.

    Raises `UnknownUnit`. Temperatures are converted as points of a scale, not as differences.
    """
    conversion = unit_of(unit, si)
    return values * conversion.scale / conversion.per + conversion.offset


def from_si(values: Number, unit: str, si: str) -> Number:
    """Convert from SI to a written unit: the inverse of `to_si`, with the same arguments.

    >>> from_si(100.0, "km/h", "m/s")
    360.0
    """
    conversion = unit_of(unit, si)
    return (values - conversion.offset) * conversion.per / conversion.scale


def is_unit(text: str, si: str | None = None) -> bool:
    """Whether ``text`` is a known unit; if ``si`` is given, of the quantity with that SI unit."""
    unit = spelling(text)
    quantities = QUANTITIES.values() if si is None else [QUANTITIES[si]]
    return any(unit in units for _, units in quantities)

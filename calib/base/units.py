"""Written units and their conversion to SI, from `units.csv`.

A unit is accepted only where its quantity is expected: ``g`` is gravity for an acceleration and an
error for a mass, ``Hz`` is revolutions per second for a wheel speed.
"""

from typing import NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from calib.base.plain import rows

Number = TypeVar("Number", float, NDArray[np.float64])


class UnknownUnit(ValueError):
    """A unit that is not in the tables, or one of another quantity."""


class Unit(NamedTuple):
    """SI value = written * scale / per + offset; 28.84 / 1e4 is exact, 28.84 * 1e-4 is not."""

    scale: float = 1.0
    per: float = 1.0
    offset: float = 0.0


BAR = 1e5  # [Pa]

_ROWS = rows("units.csv")
QUANTITIES: dict[str, tuple[str, dict[str, Unit]]] = {}
"""Quantity, and its units by name, for each SI unit."""
for _row in _ROWS:
    _numbers = {name: float(_row[name]) for name in ("scale", "per", "offset") if _row[name]}
    QUANTITIES.setdefault(_row["si"], (_row["quantity"], {}))[1][_row["unit"]] = Unit(**_numbers)
_SPELLINGS = {other: row["unit"] for row in _ROWS for other in row["spellings"].split()}

_SIGNS = str.maketrans({"²": "^2", "·": "*", "⋅": "*", "×": "*", " ": None})


def spelling(unit: str) -> str:
    """The spelling of a unit in the tables: ``m/s²`` becomes ``m/s^2``."""
    text = unit.strip().replace("N.m", "N*m").replace("**", "^")
    text = text.replace("⁻²", "^-2").replace("⁻¹", "^-1").translate(_SIGNS)
    return _SPELLINGS.get(text, text)


def unit_of(unit: str, si: str) -> Unit:
    """Return the conversion of a written unit; ``si`` is the SI unit of the quantity.

    Raises `UnknownUnit` naming the unit, the quantity wanted and its known units.
    """
    quantity, table = QUANTITIES[si]
    written = spelling(unit)
    if written in table:
        return table[written]
    owners = [other for other, units in QUANTITIES.values() if written in units]
    message = f"unknown unit {unit!r} for {quantity}"
    if owners:
        message = f"unit {unit!r} is a unit of {owners[0]}, not of {quantity}"
    raise UnknownUnit(f"{message}; known: {', '.join(table)}")


def behind(unit: str) -> str:
    """A unit as text behind a number."""
    return "" if unit == "1" else f" {unit}"


def si_of(unit: str) -> str:
    """The SI unit of a written one: ``"cm^2"`` gives ``"m^2"``. Raises `UnknownUnit`."""
    written = spelling(unit)
    for si, (_, table) in QUANTITIES.items():
        if written in table:
            return si
    names = sorted({name for _, table in QUANTITIES.values() for name in table})
    raise UnknownUnit(f"unknown unit {unit!r}; known: {', '.join(names)}")


def to_si(values: Number, unit: str, si: str) -> Number:
    """Convert ``values``, any shape, from a written ``unit`` in any known spelling to ``si``.

    The SI unit names the quantity: ``g`` is gravity for ``"m/s^2"``. Temperatures are absolute, not
    differences. Raises `UnknownUnit`.
    """
    u = unit_of(unit, si)
    return values * u.scale / u.per + u.offset


def from_si(values: Number, unit: str, si: str) -> Number:
    """Convert from SI to a written unit: the inverse of `to_si`, with the same arguments.

    >>> from_si(100.0, "km/h", "m/s")
    360.0
    """
    u = unit_of(unit, si)
    return (values - u.offset) * u.per / u.scale


def is_unit(text: str, si: str | None = None) -> bool:
    """Whether ``text`` is a known unit of the quantity with SI unit ``si``, or of any if None."""
    try:
        unit_of(text, si if si is not None else si_of(text))
    except UnknownUnit:
        return False
    return True

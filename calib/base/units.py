"""Written units and their conversion to SI: one table per quantity.

A unit is accepted only where its quantity is expected: ``g`` is gravity for an acceleration and an
error for a mass, ``Hz`` is revolutions per second for a wheel speed.
"""

from dataclasses import dataclass
from typing import TypeVar

import numpy as np
from numpy.typing import NDArray

from calib.base.names import G

Number = TypeVar("Number", float, NDArray[np.float64])
_TURN = 2.0 * np.pi


class UnknownUnit(ValueError):
    """A unit that is not in the tables, or one of another quantity."""


@dataclass(frozen=True)
class Unit:
    """SI value = written * scale / per + offset; 28.84 / 1e4 is exact, 28.84 * 1e-4 is not."""

    scale: float = 1.0
    per: float = 1.0
    offset: float = 0.0


ONE = Unit()

BAR = 1e5  # [Pa]

QUANTITIES: dict[str, tuple[str, dict[str, Unit]]] = {
    # SI unit: (quantity, {written unit: meaning})
    "s": ("time", {"s": ONE, "ms": Unit(per=1e3), "us": Unit(per=1e6), "min": Unit(60),
        "h": Unit(3600), "d": Unit(86400)}),
    "Pa": ("pressure", {
        "Pa": ONE, "hPa": Unit(100), "kPa": Unit(1e3), "MPa": Unit(1e6), "bar": Unit(1e5),
        "mbar": Unit(100),
        "psi": Unit(6894.757293168361),  # lb * g / in^2, all three by definition
    }),
    "m/s^2": ("acceleration", {"m/s^2": ONE, "g": Unit(G)}),
    "rad/s": ("angular speed", {
        "rad/s": ONE, "deg/s": Unit(_TURN, per=360), "rpm": Unit(_TURN, per=60),
        "U/min": Unit(_TURN, per=60), "1/min": Unit(_TURN, per=60), "Hz": Unit(_TURN),
    }),
    "m/s": ("speed", {
        "m/s": ONE, "km/h": Unit(10, per=36), "mm/s": Unit(per=1e3),
        "cm/s": Unit(per=100), "kph": Unit(10, per=36), "mph": Unit(0.44704),
        "kn": Unit(1852, per=3600),
    }),
    "degC": ("temperature", {
        "degC": ONE, "K": Unit(offset=-273.15), "degF": Unit(5, per=9, offset=-160 / 9),
    }),
    "rad": ("angle", {"rad": ONE, "mrad": Unit(per=1e3), "deg": Unit(_TURN, per=360)}),
    "N": ("force", {"N": ONE, "daN": Unit(10), "kN": Unit(1e3)}),
    "N*m": ("torque", {"N*m": ONE, "kN*m": Unit(1e3)}),
    "kg": ("mass", {"kg": ONE, "t": Unit(1e3), "lb": Unit(0.45359237)}),
    "m": ("length", {
        "m": ONE, "cm": Unit(per=100), "mm": Unit(per=1e3), "in": Unit(254, per=1e4),
    }),
    "m^2": ("area", {"m^2": ONE, "cm^2": Unit(per=1e4), "mm^2": Unit(per=1e6)}),
    "kg*m^2": ("moment of inertia", {"kg*m^2": ONE, "kg*cm^2": Unit(per=1e4)}),
    "1": ("dimensionless number", {"1": ONE, "-": ONE, "%": Unit(per=100)}),
    # These occur only as parameters of effects.
    "1/K": ("change per temperature", {"1/K": ONE, "1/degC": ONE, "%/K": Unit(per=100)}),
    "1/Pa": ("change per pressure", {
        "1/Pa": ONE, "1/bar": Unit(per=1e5), "1/MPa": Unit(per=1e6), "%/bar": Unit(per=1e7),
    }),
    "s/m": ("change per speed", {
        "s/m": ONE, "h/km": Unit(36, per=10), "%/(km/h)": Unit(36, per=1e3),
    }),
    "J": ("energy", {"J": ONE, "kJ": Unit(1e3), "MJ": Unit(1e6)}),
    "W": ("power", {"W": ONE, "kW": Unit(1e3)}),
}  # fmt: skip

_SPELT = (
    ("s", "sec secs Secs seconds"), ("ms", "msec milliseconds"), ("d", "day days"),
    ("us", "µs μs"), ("degC", "C °C"), ("degF", "°F"),
    ("deg", "°"), ("degC", "℃"), ("deg", "degree degrees Degrees"),
    ("deg/s", "°/s °/sec deg/sec degrees/s degps"), ("rad/s", "rad/sec radps"), ("1/degC", "1/°C"),
    ("m/s^2", "m/s/s m/sec^2 m/s2 mps2 ms2 ms^-2 m*s^-2"), ("g", "G g's"), ("Hz", "rps"),
    ("rpm", "RPM rev/min r/min"), ("1/min", "min^-1 min-1"), ("m/s", "mps"),
    ("km/h", "kmh Km/h km/hr"), ("mph", "Mph MPH"), ("kn", "knots kts"), ("psi", "PSI"),
    ("%", "percent Percent"), ("N*m", "Nm"), ("kN*m", "kNm"), ("kg*m^2", "kgm^2"), ("m^2", "m2"),
    ("cm^2", "cm2"), ("mm^2", "mm2"), ("kg*m^2", "kg*m2"), ("kg*cm^2", "kg*cm2"),
)  # fmt: skip
_SPELLINGS = {other: unit for unit, others in _SPELT for other in others.split()}
"""Other spellings of a unit, and the one in the table."""

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

    The SI unit names the quantity: ``g`` is gravity for ``"m/s^2"``. Raises `UnknownUnit`.
    Temperatures are absolute, not differences.

    >>> to_si(28.84, "cm^2", "m^2")
    0.002884
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

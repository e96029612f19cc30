"""The keys of a vehicle file, from `keys.csv`, and an example file with comments on each key.

The example is the reference car of Tables I and II of the paper. A value outside the usual range of
passenger cars and vans gives a warning. A value outside the wider bounds, from a microcar to a
heavy coach, is an error: its unit or its decimal point is wrong.
"""

import json
import textwrap
from dataclasses import dataclass
from itertools import groupby
from typing import Any

from calib.base.plain import rows, texts_of
from calib.base.units import from_si, si_of, unit_suffix
from calib.car.vehicle import Axle, Vehicle

CHASSIS, FRONT, REAR = "chassis", "front", "rear"


@dataclass(frozen=True)
class VehicleKey:
    """A key of a vehicle file."""

    section: str  # "" for a key before the sections
    name: str
    unit: str  # "" for a text, "1" for a number without unit
    low: float  # usual range, in ``unit``
    high: float
    least: float  # bounds [SI]
    most: float
    optional: bool
    example: str  # the value in the example file
    meaning: str
    measure: str  # how to measure the value
    too_low: tuple[str, ...]  # likely causes of a value outside the usual range
    too_high: tuple[str, ...]

    @property
    def path(self) -> str:
        """The key with its section, ``front.piston_area``."""
        return f"{self.section}.{self.name}" if self.section else self.name

    @property
    def default(self) -> Any:
        """Value [SI] of an optional key that a file does not give; None if it has no value then."""
        return getattr(Axle if self.section in (FRONT, REAR) else Vehicle, self.name)

    def value_of(self, vehicle: Vehicle) -> float:
        """The value in a vehicle, in ``unit``; only for a key that holds a number."""
        owner = {FRONT: vehicle.front, REAR: vehicle.rear}.get(self.section, vehicle)
        return from_si(float(getattr(owner, self.name)), self.unit, si=si_of(self.unit))


def _read(row: dict[str, str]) -> VehicleKey:
    cells: dict[str, Any] = {**row, "optional": row["optional"] == "yes"}
    for name in ("low", "high", "least", "most"):
        cells[name] = float(row[name] or 0.0)
    for name in ("too_low", "too_high"):
        cells[name] = texts_of(row[name])
    return VehicleKey(**cells)


KEYS = tuple(map(_read, rows("keys.csv", "calib.car")))  # in the order of the file

_HEAD = """\
# A vehicle for brake-cal. Values of an axle are for one wheel; quantities have a unit, in quotes.
# Judge it with `brake-cal vehicle check`, see what follows from it with `brake-cal vehicle show`.
schema = 1
"""

_TAIL = """
# What else is known of the car is given to `brake-cal fit`, which says what each would gain:
#   --mass "1800 kg"  as weighed for these runs
#   --bench B.toml    brake forces on a roller brake tester, see `brake-cal schema bench`
#   --tyre T.tir      property file of the tyres; twice: of the front and of the rear axle
#   --fleet-prior     tyres and loads are like those of the released cars of this model
"""


def vehicle_text() -> str:
    """The example file; an optional key without a default is a comment."""
    text = _HEAD
    for section, keys in groupby(KEYS, lambda key: key.section):
        head = f"[{section}]\n" if section else ""
        text += f"\n{head}" + "\n".join(map(_commented, keys))
    return text + _TAIL


def _commented(key: VehicleKey) -> str:
    measure = f"measure: {key.measure}" if key.unit else key.measure
    comments = [*textwrap.wrap(key.meaning, 96), *textwrap.wrap(measure, 96)]
    if key.unit:
        comments.append(f"usual: {key.low:g} to {key.high:g}{unit_suffix(key.unit)}")
    # a number without unit has no quotes; TOML reads a text as JSON writes it
    value = key.example if key.unit == "1" else json.dumps(key.example, ensure_ascii=False)
    is_comment = key.optional and key.default is None
    entry = f"# {key.name} = {value}" if is_comment else f"{key.name} = {value}"
    return "\n".join([*(f"# {comment}" for comment in comments), entry, ""])

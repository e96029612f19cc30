"""The keys of a vehicle file, from `keys.csv`, and a file with a comment on each.

    # mass M_v of the car as driven ...
    # measure: weigh it ready to drive ...
    # usual: 700 to 4500 kg
    mass = "1744 kg"

The examples are the reference car, `sedan-2up`, of Tables I and II of the paper. Usual ranges are
for passenger cars and vans. The bounds, from a microcar to a heavy coach, detect a wrong unit or
decimal point.
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
    """One key: ``section`` "" for the top of the file, ``unit`` "" for text, "1" for a number.

    ``low`` to ``high`` usual range in ``unit``, ``too_low`` and ``too_high`` likely causes outside
    it; ``least`` and ``most`` bounds [SI]; ``example`` as in the file.
    """

    section: str
    name: str
    unit: str
    low: float
    high: float
    least: float
    most: float
    optional: bool
    example: str
    meaning: str
    measure: str
    too_low: tuple[str, ...]
    too_high: tuple[str, ...]

    @property
    def path(self) -> str:
        """The key with its section, ``front.piston_area``."""
        return f"{self.section}.{self.name}" if self.section else self.name

    @property
    def default(self) -> float | None:
        """Value of an optional key that is not given; None where it has none."""
        part = Axle if self.section in (FRONT, REAR) else Vehicle
        value: float | None = getattr(part, self.name)
        return value

    def value_of(self, vehicle: Vehicle) -> float:
        """The value in a vehicle, in ``unit``; not for text."""
        part: Vehicle | Axle = {FRONT: vehicle.front, REAR: vehicle.rear}.get(self.section, vehicle)
        return from_si(float(getattr(part, self.name)), self.unit, si_of(self.unit))


def _read(row: dict[str, str]) -> VehicleKey:
    numbers = {name: float(row[name] or 0.0) for name in ("low", "high", "least", "most")}
    values: dict[str, Any] = {**row, **numbers, "optional": row["optional"] == "yes"}
    return VehicleKey(**values | {end: texts_of(row[end]) for end in ("too_low", "too_high")})


KEYS = tuple(map(_read, rows("keys.csv", "calib.car")))
"""The keys in the order of the file."""

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
    """The file of the reference car; an optional key without a default is a comment."""
    text = _HEAD
    for section, keys in groupby(KEYS, lambda key: key.section):
        head = f"[{section}]\n" if section else ""
        text += f"\n{head}" + "\n".join(map(_commented, keys))
    return text + _TAIL


def _commented(key: VehicleKey) -> str:
    measure = f"measure: {key.measure}" if key.unit else key.measure
    usual = [f"usual: {key.low:g} to {key.high:g}{unit_suffix(key.unit)}"] if key.unit else []
    about = (*textwrap.wrap(key.meaning, 96), *textwrap.wrap(measure, 96), *usual)
    # a text of JSON is one of TOML; a number without a unit has no quotes
    value = key.example if key.unit == "1" else json.dumps(key.example, ensure_ascii=False)
    is_comment = key.optional and key.default is None
    lines = [*(f"# {text}" for text in about), f"{'# ' * is_comment}{key.name} = {value}"]
    return "".join(f"{line}\n" for line in lines)

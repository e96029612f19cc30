"""Every key of a vehicle file, and the file with a comment on each that is made of them.

    # mass M_v of the car as driven ...
    # measure: weigh it ready to drive ...
    # usual: 700 to 4500 kg
    mass = "1744 kg"

The examples together are the reference car, `sedan-2up`, of Tables I and II of the paper. The usual
ranges hold for passenger cars and vans. The bounds only detect a wrong unit or decimal point: they
reach from a microcar to a heavy coach, and a mass that is 10 % wrong passes.
"""

import re
import textwrap
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import groupby
from typing import TYPE_CHECKING

from calib.base.toml import NUMBER
from calib.base.units import behind, from_si, si_of
from calib.car.mass import LEAST, MOST
from calib.car.vehicle import Axle, Vehicle

if TYPE_CHECKING:
    from tomlkit import TOMLDocument
    from tomlkit.items import Table

CHASSIS, FRONT, REAR = "chassis", "front", "rear"


@dataclass(frozen=True)
class VehicleKey:
    """One key: ``section`` "" for the top of the file, ``unit`` "" for text, "1" for a number.

    ``low`` and ``high`` are the usual range in ``unit``; ``least`` and ``most`` the bounds [SI];
    ``example`` as it stands in the file.
    """

    section: str
    name: str
    unit: str
    meaning: str
    measure: str
    example: str
    low: float = 0.0
    high: float = 0.0
    least: float = 0.0
    most: float = 0.0
    optional: bool = False

    @property
    def path(self) -> str:
        """The key with its section, ``front.piston_area``."""
        return f"{self.section}.{self.name}" if self.section else self.name

    @property
    def usual(self) -> str:
        """The usual range in words; empty for text."""
        return f"{self.low:g} to {self.high:g}{behind(self.unit)}" if self.unit else ""

    def value_of(self, vehicle: Vehicle) -> float:
        """The value in a vehicle, in ``unit``; not for text."""
        part: Vehicle | Axle = {FRONT: vehicle.front, REAR: vehicle.rear}.get(self.section, vehicle)
        return from_si(float(getattr(part, self.name)), self.unit, si_of(self.unit))


def _axle(
    section: str, values: tuple[str, str, str], area: tuple[float, float]
) -> list[VehicleKey]:
    inertia, piston, disc = values
    return [
        VehicleKey(
            section, "rolling_radius", "m",
            f"effective rolling radius R of one {section} wheel, unbraked",
            "roll ten turns of the wheel with the load of the test and divide the way by 20 pi; "
            "about 0.96 of the tyre's free radius",
            "0.322 m", 0.24, 0.42, 0.1, 1.0,
        ),
        VehicleKey(
            section, "wheel_inertia", "kg*m^2",
            f"moment of inertia J_w of one {section} wheel with tyre, hub and disc, about its axis",
            "from the makers of wheel and tyre, or about 0.6 x mass of wheel and tyre x R^2; on a "
            "driven axle the motor counts with the square of its gear ratio",
            inertia, 0.4, 4.0, 0.01, 200,
        ),
        VehicleKey(
            section, "piston_area", "cm^2",
            f"area A of all pistons that press one pad of one {section} brake",
            "pi/4 x diameter^2 of each piston; floating caliper: all its pistons; fixed caliper: "
            "those of one side only",
            piston, *area, 0.5e-4, 500e-4,
        ),
        VehicleKey(
            section, "effective_radius", "mm",
            f"radius r of the {section} disc at which the pads press",
            "from the axis of the wheel to the middle of the pad; a radius, not a diameter",
            disc, 80.0, 190.0, 0.03, 0.5,
        ),
        VehicleKey(
            section, "friction_faces", "1",
            f"pad faces that rub on one {section} disc",
            "2 for a disc with a pad on either side, for floating and for fixed calipers",
            "2", 2.0, 4.0, 1, 12,
        ),
        VehicleKey(
            section, "pad_friction", "1",
            f"nominal friction mu of the {section} pads",
            "from the maker of the pads, or 0.38; a common error of both axles is found by `fit`, "
            "an unequal one is not",
            "0.38", 0.28, 0.55, 0.05, 1.0,
        ),
    ]  # fmt: skip


KEYS: tuple[VehicleKey, ...] = (
    VehicleKey(
        "", "name", "",
        "name of the car with its load; tables are stored under it",
        'letters, digits, "-", "_" or "."',
        "sedan-2up",
    ),
    VehicleKey(
        CHASSIS, "mass", "kg",
        "mass M_v of the car as driven in the logs, with driver, passengers, equipment and fuel",
        "weigh it ready to drive, with everybody on board; every pad friction is wrong by the same "
        "share as the mass",
        "1744 kg", 700.0, 4500.0, LEAST, MOST,
    ),
    VehicleKey(
        CHASSIS, "cg_to_front_axle", "m",
        "distance l_f from the front axle to the centre of gravity, along the car",
        "wheelbase x load of the rear axle / mass, both weighed as driven",
        "1.1556 m", 0.7, 2.7, 0.2, 10,
    ),
    VehicleKey(
        CHASSIS, "cg_to_rear_axle", "m",
        "distance l_r from the rear axle to the centre of gravity; with l_f the wheelbase",
        "wheelbase x load of the front axle / mass; wheelbase - l_f",
        "1.6494 m", 0.7, 2.7, 0.2, 10,
    ),
    VehicleKey(
        CHASSIS, "cg_height", "m",
        "height h of the centre of gravity above the road, not above the axles",
        "from the maker; else about 0.38 x height of the roof",
        "0.615 m", 0.4, 1.0, 0.1, 3,
    ),
    VehicleKey(
        CHASSIS, "track_width", "m",
        "distance l_w between the middles of the left and the right tyre",
        "from the maker; mean of both axles",
        "1.55 m", 1.2, 1.85, 0.5, 3.5,
    ),
    VehicleKey(
        CHASSIS, "mass_tolerance", "1",
        "one standard deviation of the relative error of the mass",
        "0.005 if the car was weighed as driven; 0.03 if the load is only known roughly",
        "0.03", 0.002, 0.05, 0, 0.2, optional=True,
    ),
    VehicleKey(
        CHASSIS, "motor_odds", "1",
        "odds that a motor or an engine brakes along with the pedal and no log has its torque",
        "0 in a car without such a motor; 0.1 if nobody knows",
        "0.1", 0.0, 10.0, 0, 100, optional=True,
    ),
    *_axle(FRONT, ("1.20 kg*m^2", "28.84 cm^2", "130.9 mm"), (12.0, 66.0)),
    *_axle(REAR, ("1.10 kg*m^2", "11.34 cm^2", "124.0 mm"), (3.0, 36.0)),
)  # fmt: skip
"""The keys in the order of the file."""

REFERENCE = {key.path: key.example for key in KEYS}
"""What the file of the reference car says, by path of the key."""

_WIDTH = 96
"""Longest comment [characters]."""

_HEAD = """\
A vehicle for brake-cal. Values of an axle are for one wheel; quantities have a unit, in quotes.
Judge it with `brake-cal vehicle check`, see what follows from it with `brake-cal vehicle show`."""


def vehicle_text(values: Mapping[str, str]) -> str:
    """The file with ``values`` by path of the key, as written: "1744 kg" or "2".

    A key without a value is a comment if it is optional. Raises KeyError for another one.
    """
    import tomlkit

    document = tomlkit.document()
    for line in _HEAD.splitlines():
        document.add(tomlkit.comment(line))
    document.add("schema", 1)
    for section, keys in groupby(KEYS, lambda key: key.section):
        document.add(tomlkit.nl())
        part = tomlkit.table() if section else document
        _fill(part, list(keys), values)
        if section:
            document.add(section, part)
    return tomlkit.dumps(document)


def _fill(part: "TOMLDocument | Table", keys: list[VehicleKey], values: Mapping[str, str]) -> None:
    import tomlkit

    for i, key in enumerate(keys):
        if i:
            part.add(tomlkit.nl())
        for line in _comments(key):
            part.add(tomlkit.comment(line))
        if key.path in values or not key.optional:
            part.add(key.name, _written(key, values[key.path]))
        else:
            part.add(tomlkit.comment(f"{key.name} = {key.example}"))


def _comments(key: VehicleKey) -> Iterator[str]:
    yield from textwrap.wrap(key.meaning, _WIDTH)
    yield from textwrap.wrap(f"measure: {key.measure}" if key.unit else key.measure, _WIDTH)
    if key.usual:
        yield f"usual: {key.usual}"


def _written(key: VehicleKey, value: str) -> str | int | float:
    """A number without quotes where the key is one, as a person writes it."""
    if key.unit != "1" or re.fullmatch(NUMBER, value) is None:
        return value
    number = float(value)
    return int(number) if number == int(number) else number

"""A vehicle as a TOML file: quantities with units, such as ``mass = "1744 kg"``.

The bounds detect a wrong unit or decimal point, not small errors: they reach from a microcar to a
heavy coach, and a mass that is 10 % wrong passes.
"""

from collections.abc import Mapping
from dataclasses import fields
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, Self

from pydantic import AfterValidator, Field, create_model, model_validator

from calib.base.errors import VehicleError
from calib.base.schema import (
    FileSchema,
    QuantityMark,
    Section,
    quantities,
    read_toml,
    validated,
)
from calib.base.schema_errors import wrong
from calib.base.toml import toml_bytes, written_quantity
from calib.base.write import write_whole
from calib.car.effects.effects import Effects
from calib.car.mass import LEAST, MOST
from calib.car.vehicle import Axle, Vehicle

if TYPE_CHECKING:
    from tomlkit.items import Table

_FORBIDDEN_IN_NAME = frozenset('@/\\:*?"<>|')


def _name(name: str) -> str:
    """A table has the name of its vehicle, so it must be valid as a folder and before an ``@``."""
    bad = not name.strip() or name.startswith(".") or name != name.strip()
    if bad or not name.isprintable() or _FORBIDDEN_IN_NAME & set(name):
        raise wrong(f"{name!r} cannot name a table", 'letters, digits, "-", "_" or "."')
    return name


def _whole(number: float) -> int:
    if number != int(number):
        raise wrong(f"{number:g}", "a whole number: 2 for a disc brake")
    return int(number)


class ChassisSection(Section):
    """Masses and lengths, as in `Vehicle`."""

    mass: Annotated[float, QuantityMark("kg", LEAST, MOST)]
    cg_to_front_axle: Annotated[float, QuantityMark("m", 0.2, 10)]
    cg_to_rear_axle: Annotated[float, QuantityMark("m", 0.2, 10)]
    cg_height: Annotated[float, QuantityMark("m", 0.1, 3)]
    track_width: Annotated[float, QuantityMark("m", 0.5, 3.5)]
    mass_tolerance: Annotated[float, QuantityMark("1", 0, 0.2)] = Vehicle.mass_tolerance
    motor_odds: Annotated[float, QuantityMark("1", 0, 100)] = Vehicle.motor_odds

    @model_validator(mode="after")
    def _is_low_enough(self) -> Self:
        wheelbase = self.cg_to_front_axle + self.cg_to_rear_axle
        if self.cg_height >= wheelbase:
            raise wrong(
                f"cg_height {self.cg_height:g} m is not below the wheelbase {wheelbase:g} m",
                "cg_height < cg_to_front_axle + cg_to_rear_axle",
            )
        return self


class AxleSection(Section):
    """One axle, as in `Axle`; every value is for one wheel."""

    rolling_radius: Annotated[float, QuantityMark("m", 0.1, 1.0)]
    wheel_inertia: Annotated[float, QuantityMark("kg*m^2", 0.01, 200)]
    piston_area: Annotated[float, QuantityMark("m^2", 0.5e-4, 500e-4)]
    effective_radius: Annotated[float, QuantityMark("m", 0.03, 0.5)]
    friction_faces: Annotated[int, QuantityMark("1", 1, 12), AfterValidator(_whole)]
    pad_friction: Annotated[float, QuantityMark("1", 0.05, 1.0)]

    @model_validator(mode="after")
    def _disc_fits(self) -> Self:
        if self.effective_radius >= self.rolling_radius:
            raise wrong(
                f"effective_radius {self.effective_radius:g} m is not below rolling_radius "
                f"{self.rolling_radius:g} m",
                "a disc that fits into the wheel",
            )
        return self


KnownEffect = dict[str, Annotated[float, QuantityMark(None, -1e12, 1e12)]]


class VehicleFile(FileSchema):
    """A vehicle: Tables I and II of the paper, and the known effects.

    The names of effects are not checked here: `calib.car.model.default_model` does so.
    """

    name: Annotated[str, AfterValidator(_name)]
    chassis: ChassisSection
    front: AxleSection
    rear: AxleSection
    effects: dict[str, KnownEffect] = Field(default_factory=dict)


def read_vehicle(path: Path | str) -> Vehicle:
    """Read a vehicle file (TOML, ``schema = 1``, quantities as strings with units).

    Raises VehicleError for a file that is missing, not TOML, of another schema; for a missing or
    unknown key; for a wrong unit; for a value that is not believable.

    >>> import calib
    >>> car = calib.read_vehicle(calib.sample_logs() / "sedan" / "vehicle.toml")
    >>> car.name, car.mass, round(car.wheelbase, 3), car.front.friction_faces  # kg, m
    ('sedan-2up', 1744.0, 2.805, 2)
    """
    file = read_toml(Path(path), VehicleFile, VehicleError)
    return Vehicle(
        name=file.name,
        **dict(file.chassis),
        front=Axle(**dict(file.front)),
        rear=Axle(**dict(file.rear)),
        effects=Effects(file.effects),
    )


def refuse_value(section: str, key: str, written: str) -> None:
    """Raise VehicleError for a value that a key cannot have; ``section`` is "" for the name."""
    kind: type[Section] = VehicleFile
    if section:
        kind = ChassisSection if section == "chassis" else AxleSection
    field = kind.model_fields[key]
    definition: dict[str, Any] = {key: (Annotated[field.annotation, *field.metadata], ...)}
    alone = create_model(key, __base__=Section, **definition)
    try:
        validated({key: written}, alone, None, VehicleError)
    except VehicleError as error:  # without the key: the question names it
        raise VehicleError(error.what, expected=error.expected) from error


def write_vehicle(vehicle: Vehicle, path: Path) -> None:
    """Write a vehicle file that `read_vehicle` reads back exactly. All values are in SI.

    Raises VehicleError for a value that is not believable and for an empirical term, which such a
    file cannot hold; OSError if ``path`` cannot be written.
    """
    if vehicle.effects.terms:
        raise VehicleError(
            "a vehicle file cannot hold an empirical term",
            where=vehicle.name,
            do="write a model file",
        )
    document: dict[str, Any] = {
        "schema": 1,
        "name": vehicle.name,
        "chassis": _written(vehicle, ChassisSection),
        "front": _written(vehicle.front, AxleSection),
        "rear": _written(vehicle.rear, AxleSection),
    }
    if vehicle.effects.names:
        named = vehicle.effects.parameters
        document["effects"] = {name: _in_si(values) for name, values in named.items()}
    validated(document, VehicleFile, vehicle.name, VehicleError)
    write_whole(Path(path), toml_bytes(document))


def _in_si(values: Mapping[str, float]) -> "Table":
    import tomlkit

    table = tomlkit.table()
    table.comment("SI")
    table.update(values)
    return table


def _written(part: Vehicle | Axle, section: type[Section]) -> dict[str, Any]:
    units = {name: mark.si or "1" for name, mark in quantities(section).items()}
    return {
        field.name: written_quantity(getattr(part, field.name), units[field.name])
        for field in fields(part)
        if field.name in units
    }

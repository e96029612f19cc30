"""A vehicle as a TOML file, with the keys, units and bounds of `calib.car.keys`."""

from pathlib import Path
from typing import Annotated, Any

from pydantic import AfterValidator, Field, model_validator

from calib.base.errors import VehicleError
from calib.base.names import TABLE_NAME_RULE, names_a_table
from calib.base.record import FileSchema, QuantityMark, Section, read_toml, section
from calib.base.record_errors import wrong
from calib.base.units import si_of
from calib.car.effects.effects import Effects
from calib.car.keys import CHASSIS, FRONT, KEYS
from calib.car.vehicle import Axle, Vehicle


def _require_table_name(name: str) -> str:
    if not names_a_table(name):  # the name of a vehicle is that of its tables
        raise wrong(f"{name!r} cannot name a table", TABLE_NAME_RULE)
    return name


def _require_whole(number: float) -> int:
    if number != int(number):
        raise wrong(f"{number:g}", "a whole number: 2 for a disc brake")
    return int(number)


def _keys_of(section_name: str) -> dict[str, tuple[Any, Any]]:
    """Return type and default of each key of a section, as `calib.base.record.section` expects."""
    keys: dict[str, tuple[Any, Any]] = {}
    for key in KEYS:
        if key.section == section_name:
            kind: Any = Annotated[float, QuantityMark(si_of(key.unit), key.least, key.most)]
            if key.name == "friction_faces":
                kind = Annotated[kind, AfterValidator(_require_whole)]
            keys[key.name] = (kind, key.default if key.optional else ...)
    return keys


class _Chassis(Section):  # the keys follow in `_ChassisSection`
    @model_validator(mode="after")
    def _is_low_enough(self: Any) -> Any:
        height, wheelbase = self.cg_height, self.cg_to_front_axle + self.cg_to_rear_axle
        if height >= wheelbase:
            flaw = f"cg_height {height:g} m is not below the wheelbase {wheelbase:g} m"
            raise wrong(flaw, "cg_height < cg_to_front_axle + cg_to_rear_axle")
        return self


class _Axle(Section):  # the keys follow in `_AxleSection`
    @model_validator(mode="after")
    def _disc_fits(self: Any) -> Any:
        disc, wheel = self.effective_radius, self.rolling_radius
        if disc >= wheel:
            flaw = f"effective_radius {disc:g} m is not below rolling_radius {wheel:g} m"
            raise wrong(flaw, "a disc that fits into the wheel")
        return self


_ChassisSection: Any = section(
    "_ChassisSection", "Masses and lengths, as in `Vehicle`.", _keys_of(CHASSIS), _Chassis
)
_AxleSection: Any = section(
    "_AxleSection", "One axle, as in `Axle`; every value is for one wheel.", _keys_of(FRONT), _Axle
)
_Parameter = Annotated[float, QuantityMark(None, -1e12, 1e12)]  # a quantity of any unit


class VehicleFile(FileSchema):
    """A vehicle: Tables I and II of the paper, and the known effects.

    The names of effects are not checked here: `calib.car.model.default_model` does so.
    """

    name: Annotated[str, AfterValidator(_require_table_name)]
    chassis: _ChassisSection
    front: _AxleSection
    rear: _AxleSection
    effects: dict[str, dict[str, _Parameter]] = Field(default_factory=dict)


def read_vehicle(path: Path | str) -> Vehicle:
    """Read a vehicle file (TOML, ``schema = 1``, quantities as strings with units).

    Raises one VehicleError with all mistakes in the file.

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

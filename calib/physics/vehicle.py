"""Tables I and II of the paper as a frozen record.

Wheel values are per wheel. ``friction_faces`` counts the pad faces of one caliper (two for a disc
brake): (2) of the paper is for one face.
"""

import json
import math
from dataclasses import dataclass, field, fields
from pathlib import Path
from typing import Any

from calib.names import G
from calib.physics.effects.effects import Effects
from calib.toml import check_keys, quantity, read_toml

SCHEMA = 1


@dataclass(frozen=True)
class Axle:
    """One axle of Table I; every value is for one wheel.

    Attributes
    ----------
    rolling_radius : R [m], effective, unbraked.
    wheel_inertia : J_w [kg m^2], about the wheel axis. Not in the paper.
    piston_area : A [m^2], all pistons that press one pad.
    effective_radius : r [m], of the disc.
    friction_faces : pad faces of one brake [1].
    pad_friction : mu_p,n [1], nominal.
    """

    rolling_radius: float
    wheel_inertia: float
    piston_area: float
    effective_radius: float
    friction_faces: int
    pad_friction: float

    @property
    def torque_gain(self) -> float:
        """C of (3) for one wheel [m^3]: faces * A * r, so that T_b = mu_p C P."""
        return self.friction_faces * self.piston_area * self.effective_radius


@dataclass(frozen=True)
class Vehicle:
    """Table II of the paper, both axles, and the effects known beforehand.

    Attributes
    ----------
    name : names the tables fitted with it.
    mass : M_v [kg], as driven.
    cg_to_front_axle, cg_to_rear_axle : l_f, l_r [m].
    cg_height : h [m].
    track_width : l_w [m].
    front, rear : the axles.
    mass_tolerance : one standard deviation of the relative error of the mass [1].
    effects : what is known to act in it beside the paper's model.
    """

    name: str
    mass: float
    cg_to_front_axle: float
    cg_to_rear_axle: float
    cg_height: float
    track_width: float
    front: Axle
    rear: Axle
    mass_tolerance: float = 0.005
    effects: Effects = field(default_factory=Effects)

    @property
    def wheelbase(self) -> float:
        """L = l_f + l_r [m]."""
        return self.cg_to_front_axle + self.cg_to_rear_axle

    @property
    def weight(self) -> float:
        """M_v g [N]."""
        return self.mass * G


@dataclass(frozen=True)
class Bound:
    """A value of the vehicle file: its SI unit and the range in which it is believable [SI]."""

    si: str
    low: float
    high: float


# From a microcar to a heavy coach. A value outside is a slip of the unit or of the decimal point.
CHASSIS = {
    "mass": Bound("kg", 300, 60_000),
    "cg_to_front_axle": Bound("m", 0.2, 10),
    "cg_to_rear_axle": Bound("m", 0.2, 10),
    "cg_height": Bound("m", 0.1, 3),
    "track_width": Bound("m", 0.5, 3.5),
    "mass_tolerance": Bound("1", 0, 0.2),
}
AXLE = {
    "rolling_radius": Bound("m", 0.1, 1.0),
    "wheel_inertia": Bound("kg*m^2", 0.01, 200),
    "piston_area": Bound("m^2", 0.5e-4, 500e-4),
    "effective_radius": Bound("m", 0.03, 0.5),
    "friction_faces": Bound("1", 1, 12),
    "pad_friction": Bound("1", 0.05, 1.0),
}
OPTIONAL = ("mass_tolerance",)
_FORBIDDEN_IN_NAME = frozenset('@/\\:*?"<>|')


def checked(vehicle: Vehicle, where: object = None) -> Vehicle:
    """Return the vehicle if every value is believable.

    Raises VehicleError naming ``where`` (the vehicle's name by default), the value and its bounds.
    It sees slips, not small errors: a mass that is 10 % wrong passes.
    """
    where = vehicle.name if where is None else where
    _check_name(vehicle.name, where)
    for key, bound in CHASSIS.items():
        _within(getattr(vehicle, key), bound, f"{where}: chassis.{key}")
    for axle in ("front", "rear"):
        for key, bound in AXLE.items():
            _within(getattr(getattr(vehicle, axle), key), bound, f"{where}: {axle}.{key}")
    _check_geometry(vehicle, where)
    for effect, parameters in vehicle.effects.parameters.items():
        for key, value in parameters.items():
            _within(value, Bound("SI", -1e12, 1e12), f"{where}: effects.{effect}.{key}")
    return vehicle


def _check_name(name: str, where: object) -> None:
    """A table is named after its vehicle, so the name must do as a folder and before an ``@``."""
    bad = not name.strip() or name.startswith(".") or name != name.strip()
    if bad or not name.isprintable() or _FORBIDDEN_IN_NAME & set(name):
        raise VehicleError(
            f"name {name!r} cannot name a table",
            where=where,
            expected='letters, digits, "-", "_" or "."',
        )


def _within(value: float, bound: Bound, where: str) -> None:
    if not (math.isfinite(value) and bound.low <= value <= bound.high):
        raise VehicleError(
            f"{value:g} {bound.si} is not believable",
            where=where,
            expected=f"{bound.low:g} to {bound.high:g} {bound.si}",
            do="check the sign, the unit and the decimal point",
        )


def _check_geometry(vehicle: Vehicle, where: object) -> None:
    if vehicle.cg_height >= vehicle.wheelbase:
        raise VehicleError(
            f"cg_height {vehicle.cg_height:g} m is not below the wheelbase {vehicle.wheelbase:g} m",
            where=f"{where}: chassis",
            expected="cg_height < cg_to_front_axle + cg_to_rear_axle",
        )
    for name, axle in (("front", vehicle.front), ("rear", vehicle.rear)):
        if axle.effective_radius >= axle.rolling_radius:
            raise VehicleError(
                f"effective_radius {axle.effective_radius:g} m is not below rolling_radius "
                f"{axle.rolling_radius:g} m",
                where=f"{where}: {name}",
                expected="a disc that fits into the wheel",
            )
        if axle.friction_faces != int(axle.friction_faces):
            raise VehicleError(
                f"friction_faces {axle.friction_faces:g}",
                where=f"{where}: {name}",
                expected="a whole number: 2 for a disc brake",
            )


def read_vehicle(path: Path | str) -> Vehicle:
    """Read a vehicle file (TOML, ``schema = 1``, quantities as strings with units).

    ``[chassis]``, ``[front]`` and ``[rear]`` as in the records above; ``[effects.<name>]``, if
    any, hold the known parameters of that effect. Their names are not checked here: the catalogue
    of effects lies further down and does so.

    Raises VehicleError for a file that is missing, not TOML, of another schema; for a missing or
    unknown key; for a wrong unit; for a value that is not believable.

    >>> import calib
    >>> car = calib.read_vehicle(calib.sample_logs() / "sedan" / "vehicle.toml")
    >>> car.name, car.mass, round(car.wheelbase, 3), car.front.friction_faces  # kg, m
    ('sedan-2up', 1744.0, 2.805, 2)
    """
    path = Path(path)
    table = read_toml(path, SCHEMA, VehicleError)
    required = ("name", "chassis", "front", "rear")
    check_keys(table, (*required, "effects"), required, path, VehicleError)
    if not isinstance(table["name"], str):
        raise VehicleError(f"name {table['name']!r}", where=path, expected="a string")
    vehicle = Vehicle(
        name=table["name"],
        **_section(table["chassis"], CHASSIS, f"{path}: chassis"),
        front=_axle(table["front"], f"{path}: front"),
        rear=_axle(table["rear"], f"{path}: rear"),
        effects=Effects(_effects(table.get("effects", {}), path)),
    )
    return checked(vehicle, path)


def _section(table: object, bounds: dict[str, Bound], where: str) -> dict[str, float]:
    required = [key for key in bounds if key not in OPTIONAL]
    values = check_keys(table, bounds, required, where, VehicleError)
    return {
        key: quantity(value, bounds[key].si, f"{where}.{key}", VehicleError)
        for key, value in values.items()
    }


def _axle(table: object, where: str) -> Axle:
    values: dict[str, Any] = dict(_section(table, AXLE, where))
    faces = values["friction_faces"]
    return Axle(**{**values, "friction_faces": int(faces) if faces == int(faces) else faces})


def _effects(table: object, path: Path) -> dict[str, dict[str, float]]:
    where = f"{path}: effects"
    if not isinstance(table, dict):
        raise VehicleError(f"{table!r} is not a table", where=where, expected="[effects.<name>]")
    effects = {}
    for name, parameters in table.items():
        if not isinstance(parameters, dict):
            raise VehicleError(
                f"{name} = {parameters!r} is not a table", where=where, expected=f"[effects.{name}]"
            )
        effects[name] = {
            key: quantity(value, None, f"{where}.{name}.{key}", VehicleError)
            for key, value in parameters.items()
        }
    return effects


def write_vehicle(vehicle: Vehicle, path: Path) -> None:
    """Write a vehicle file that `read_vehicle` reads back exactly. All values are in SI.

    Raises VehicleError for a value that is not believable, and for an empirical term, which only a
    model file can hold; OSError if ``path`` cannot be written.
    """
    checked(vehicle)
    if vehicle.effects.terms:
        raise VehicleError(
            "a vehicle file cannot hold an empirical term",
            where=vehicle.name,
            expected="named effects only",
            do="write a model file",
        )
    lines = [f"schema = {SCHEMA}", f"name = {json.dumps(vehicle.name, ensure_ascii=False)}"]
    lines += ["", "[chassis]", *(_line(k, getattr(vehicle, k), b.si) for k, b in CHASSIS.items())]
    for name in ("front", "rear"):
        axle = getattr(vehicle, name)
        values = {f.name: getattr(axle, f.name) for f in fields(Axle)}
        lines += ["", f"[{name}]", *(_line(k, v, AXLE[k].si) for k, v in values.items())]
    for effect, parameters in vehicle.effects.parameters.items():
        lines += ["", f"[effects.{_key(effect)}]  # SI"]
        lines += [_line(key, value, "1") for key, value in parameters.items()]
    write_whole(Path(path), "\n".join([*lines, ""]).encode())


def _line(key: str, value: float, si: str) -> str:
    number = repr(value) if isinstance(value, int) else repr(float(value))
    return f"{_key(key)} = {number}" if si == "1" else f'{_key(key)} = "{number} {si}"'


def _key(name: str) -> str:
    bare = name.isascii() and name.replace("-", "_").isidentifier()
    return name if bare else json.dumps(name, ensure_ascii=False)

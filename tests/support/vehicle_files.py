"""Vehicle files of made cars: the program itself writes that of the reference car alone."""

from dataclasses import asdict
from pathlib import Path

import tomlkit

from calib.base.toml import written_quantity
from calib.base.units import si_of
from calib.car.keys import KEYS
from calib.car.vehicle import Vehicle


def write_vehicle(vehicle: Vehicle, path: Path) -> None:
    """Write a vehicle file that `read_vehicle` reads back exactly, all values in SI."""
    values = asdict(vehicle)
    document: dict[str, object] = {"schema": 1, "name": vehicle.name}
    for key in KEYS[1:]:
        value = values.get(key.section, values)[key.name]
        part = document.setdefault(key.section, {})
        if value is not None:
            part[key.name] = written_quantity(value, si_of(key.unit))  # type: ignore[index]
    if vehicle.effects.names:
        document["effects"] = {n: dict(own) for n, own in vehicle.effects.parameters.items()}
    path.write_bytes(tomlkit.dumps(document).encode())

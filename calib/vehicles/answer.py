"""An answer to the question for one key of a vehicle file."""

import re
from collections.abc import Mapping

from calib.documents.toml import NUMBER
from calib.errors import InputError, VehicleError
from calib.vehicles.keys import FRONT, REAR, VehicleKey


def answered(key: VehicleKey, typed: str) -> str:
    """The value as it stands in the file; a number without a unit gets that of the key.

    Raises VehicleError for what a vehicle file could not hold, with what was expected.
    """
    from calib.physics.vehicle_file import refuse_value

    text = typed.strip()
    if key.unit and "," in text:
        raise VehicleError(f"{text!r} has a comma", expected=f"a decimal point: {key.example}")
    bare = re.fullmatch(NUMBER, text) is not None
    value = f"{text} {key.unit}" if bare and key.unit not in ("", "1") else text
    try:
        refuse_value(key.section, key.name, value)
    except InputError as error:
        expected = error.expected or f"a value such as {key.example}"
        do = f"usual: {key.usual}" if key.unit else ""
        raise VehicleError(error.what, expected=expected, do=do) from error
    return value


def default_of(key: VehicleKey, before: Mapping[str, str]) -> str:
    """The value that Enter takes: for the rear wheel that of the front one, else the example."""
    same = f"{FRONT}.{key.name}"
    alike = key.section == REAR and key.name in ("rolling_radius", "friction_faces", "pad_friction")
    return before[same] if alike else key.example

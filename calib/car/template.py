"""A vehicle file with a comment on every key, ready to be edited, from answers to questions.

# mass M_v of the car as driven ...
# measure: weigh it ready to drive ...
# usual: 700 to 4500 kg
mass = "1744 kg"
"""

import re
import textwrap
from collections.abc import Iterator, Mapping
from itertools import groupby
from typing import TYPE_CHECKING

from calib.base.errors import InputError, VehicleError
from calib.base.toml import NUMBER
from calib.car.keys import FRONT, KEYS, REAR, VehicleKey

if TYPE_CHECKING:
    from tomlkit import TOMLDocument
    from tomlkit.items import Table

WIDTH = 96
"""Longest comment [characters]."""

HEAD = """\
A vehicle for brake-cal. Values of an axle are for one wheel; quantities have a unit, in quotes.
Judge it with `brake-cal vehicle check`, see what follows from it with `brake-cal vehicle show`."""


def vehicle_text(values: Mapping[str, str]) -> str:
    """The file with ``values`` by path of the key, as written: "1744 kg" or "2".

    A key without a value is a comment if it is optional. Raises KeyError for another one.
    """
    import tomlkit

    document = tomlkit.document()
    for line in HEAD.splitlines():
        document.add(tomlkit.comment(line))
    document.add("schema", 1)
    for section, keys in groupby(KEYS, lambda key: key.section):
        if section:
            table = tomlkit.table()
            _fill(table, list(keys), values)
            document.add(tomlkit.nl())
            document.add(section, table)
        else:
            document.add(tomlkit.nl())
            _fill(document, list(keys), values)
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
    yield from textwrap.wrap(key.meaning, WIDTH)
    yield from textwrap.wrap(f"measure: {key.measure}" if key.unit else key.measure, WIDTH)
    if key.usual:
        yield f"usual: {key.usual}"


def _written(key: VehicleKey, value: str) -> str | int | float:
    """A number without quotes where the key is one, as a person writes it."""
    if key.unit != "1":
        return value
    try:
        number = float(value)
    except ValueError:  # a percentage
        return value
    return int(number) if number == int(number) else number


def answered(key: VehicleKey, typed: str) -> str:
    """The value as it stands in the file; a number without a unit gets that of the key.

    Raises VehicleError for what a vehicle file could not hold, with what was expected.
    """
    from calib.car.vehicle_file import refuse_value

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

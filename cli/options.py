"""Options and arguments: how each is typed, and what it becomes before a command gets it.

`option` and `argument` are typer's, with a conversion ``make``. The annotation of a parameter is
the type that the command gets; ``typed`` is that which a user types, for typer.
"""

from collections.abc import Callable, Collection
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from calib.base.names import STORE
from cli.console import at_option, misuse, say, this_run

if TYPE_CHECKING:
    from calib.car.effects.catalogue import OwnEffect
    from calib.car.vehicle import Vehicle
    from calib.estimation.limits import Limit
    from calib.logs.channel_map import ChannelMap
    from calib.store.store import Store

LIMITS_OF_STOPS = "calib.line.station.limits_file:limits_of_stops"
NO_VEHICLE = 'give --vehicle V.toml, or write vehicle = "V.toml" into brake-cal.toml'
"""What to do where a vehicle is needed and none was named."""
_LISTED = 60
"""Up to so many known names are listed after an unknown one; of a longer list only the nearest."""
Make = Callable[[Any], Any] | str
"""A conversion: a function, or "module:NAME" of one that is imported when it is used."""


def option(text: str, metavar: str | None = None, *flags: str, **more: Any) -> Any:
    """An option with its help ``text``.

    Parameters
    ----------
    flags : how it is written, if not as its parameter.
    more : for typer, and these:

        typed       type that is typed, if it differs; a path where the annotation is quoted
        make        conversion
        always      convert None, too
        names       "module:NAME" of the known values: completed, others refused
        writes      kind of the output file that it names, see `cli.outputs`, or "folder"
        setting     key of the settings file that gives its value if it is not given
        when        function of all given options by name: whether the setting is used
        built_in    value if nothing else gives one
    """
    typer_option: Any = typer.Option  # its types take the first flag for a default
    return _declared(partial(typer_option, *flags), text, metavar, flags=flags, **more)


_OURS: dict[str, Any] = {
    "typed": None,
    "always": False,
    "writes": None,
    "built_in": None,
    "flags": None,
    "setting": "",
    "when": lambda given: True,
}
"""Keys of ``more`` that typer does not know, with their default values."""


def argument(text: str, metavar: str, **more: Any) -> Any:
    """An argument; see `option`."""
    return _declared(typer.Argument, text, metavar, **more)


def _declared(
    kind: Any,
    text: str,
    metavar: str | None,
    *,
    make: Make | None = None,
    names: str = "",
    **more: Any,
) -> Any:
    if names:
        more["autocompletion"] = lambda incomplete: _names(names)
    ours = {name: more.pop(name, default) for name, default in _OURS.items()}
    declared = kind(help=text, metavar=metavar, **more)
    vars(declared).update(ours, make=_checked(make, names) if make or names else None)
    return declared


def _checked(make: Make | None, names: str) -> Callable[[Any], Any]:
    def checked(value: Any) -> Any:
        if names and isinstance(value, list):
            value = [require_known(one, _names(names)) for one in value]
        elif names:
            value = require_known(value, _names(names))
        convert = _imported(make) if isinstance(make, str) else make
        return convert(value) if convert else value

    return checked


def _imported(place: str) -> Any:
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def _names(place: str) -> list[str]:
    names = _imported(place)
    return [str(one) for one in (names() if callable(names) else names)]


def require_known(written: str, names: Collection[str], noun: str = "") -> str:
    """The known name that was written, in capitals or not. Refuses an unknown one."""
    from calib.base.toml import did_you_mean

    match = [written] if written in names else [x for x in names if x.lower() == written.lower()]
    if not match:
        near = did_you_mean(written, names)
        listing = f"known: {', '.join(names)}" if len(names) <= _LISTED else ""
        raise misuse("; ".join(filter(None, (f"unknown {noun}{written!r}", near, listing))))
    return match[0]


def from_settings(key: str) -> Any:
    """The value of a setting, None for none; the file is read once in a run."""
    run = this_run()
    if run.project is None:
        from calib.base.settings_file import find_project

        run.project = find_project()
    value = run.project.settings[key]
    if value is not None and not run.uses_settings:
        run.uses_settings = True
        say(f"settings of {run.project.file}")
    return value


def read_vehicle(path: Path | None) -> "Vehicle":
    """The car of a vehicle file."""
    from calib.car import vehicle_file

    if path is None:
        raise misuse(f"missing; {NO_VEHICLE}")
    return vehicle_file.read_vehicle(path)


def in_si(unit: str, written: str) -> float:
    """A quantity with its unit, converted to the SI ``unit``."""
    from calib.base.errors import InputError
    from calib.base.toml import quantity

    with at_option(None, InputError):
        return quantity(written, unit, None, InputError)


def words(written: str) -> str:
    """A text that is not empty."""
    if not written.strip():
        raise misuse("says nothing")
    return written


def _version(table: str) -> str:
    if "@" not in table:
        raise misuse(f"{table!r} names no version; give {table}@N, see `brake-cal tables list`")
    return table


# Shared options. A quoted type is what the command gets; typer reads the path of a file.


def limits(text: str, make: str, always: bool = True, **more: Any) -> Any:
    """Option for a file of limits, which the settings may name."""
    return option(text, "L.toml", make=make, always=always, setting="limits", **more)


def channel_map(text: str = "Channel map, and DBC.", **more: Any) -> Any:
    """Option for a channel map."""
    return option(
        text, "M.toml", "--map", make="calib.logs.channel_map_file:read_channel_map", **more
    )


def vehicle(text: str, always: bool = False, **more: Any) -> Any:
    """Option for a vehicle file."""
    return option(text, "V.toml", make=read_vehicle, always=always, **more)


Tables = Annotated[
    "Store",
    option("Directory of the tables, tables/ if not given.", "DIR", typed=Path,
           make="calib:Store", built_in=STORE, setting="store"),
]  # fmt: skip
Car = Annotated[
    "Vehicle", vehicle("Vehicle file; else that of the settings.", always=True, setting="vehicle")
]
OtherPads = Annotated[
    "Vehicle | None", vehicle("Other nominal pads than the table's; never the settings' vehicle.")
]
Map = Annotated["ChannelMap | None", channel_map(setting="map")]
_MASS = 'Mass of the car in these logs, such as "1650 kg", if not that of the vehicle file.'
Mass = Annotated["float | None", option(_MASS, "MASS", typed=str | None, make=partial(in_si, "kg"))]
_READ_EFFECTS = "calib.car.effects.effect_file:read_own_effects"
EFFECT = (
    "Add an effect of your own (`brake-cal manual own_effects`); may be repeated. The file is "
    "executed as Python: give only files that you trust."
)
OwnEffects = Annotated[
    "tuple[OwnEffect, ...]", option(EFFECT, "FILE.py", typed=list[Path], make=_READ_EFFECTS)
]
StopLimits = Annotated[
    "tuple[Limit, ...]", limits("Limits that decide pass or fail.", LIMITS_OF_STOPS)
]
KnownModel = Annotated[
    Path | None, option("Model of `diagnose`, whose effects are then known.", "M.toml")
]
Workers = Annotated[int | None, option("Processes; else all cores.", "N", min=1, max=512)]
BY = "Name of who decides; else the person of the settings, or the user of this computer."
By = Annotated[str | None, option(BY, "NAME", setting="by")]
Reason = Annotated[str, option("Why, for the journal.", "TEXT", make=words)]
TABLE = "name, name@version or path of a version"
Table = Annotated[str, argument(TABLE, "TABLE")]
Version = Annotated[str, argument("name@version", "TABLE@N", make=_version)]
KEY = "Public key: its file, or its text."
PublicKey = Annotated[str | None, option(KEY, "PUBLIC", setting="keys.public")]
Required = Annotated[
    bool, option("Refuse a table without a signature that holds.", setting="require_signed")
]
SignedBy = Annotated[
    str | None,
    option(f"{KEY} With --require-signed.", "PUBLIC", setting="keys.public",
           when=lambda given: bool(given["require_signed"])),
]  # fmt: skip

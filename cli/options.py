"""Options and arguments of the commands, and the conversion of what is typed.

The annotation of a parameter is the type of the value that the command gets. A quoted annotation
says that the path of a file is typed, and converted to a type that is not imported here. Options
that several commands share are at the end.
"""

from collections.abc import Callable, Collection, Mapping
from dataclasses import dataclass, fields
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from calib.base.names import STORE
from cli.console import at_option, say, this_run, usage_error

if TYPE_CHECKING:
    from calib.car.effects.catalogue import OwnEffect
    from calib.car.vehicle import Vehicle
    from calib.estimation.limits import Limit
    from calib.logs.channel_map import ChannelMap
    from calib.store.store import Store

LIMITS_OF_STOPS = "calib.line.station.limits_file:limits_of_stops"
NO_VEHICLE = 'give --vehicle V.toml, or write vehicle = "V.toml" into brake-cal.toml'
_MAX_LISTED = 60  # largest number of known names that the message on an unknown name lists
Make = Callable[[Any], Any] | str
"""A conversion: a function, or "module:NAME" of a function that is imported when it is used."""


@dataclass(frozen=True)
class Extra:
    """Properties of an option or argument that typer does not have."""

    typed: Any = None  # type of the typed value, if it is not that of the annotation
    make: Callable[[Any], Any] | None = None  # conversion to what the command gets
    always: bool = False  # whether None is converted, too
    writes: str | None = None  # kind of an output file, see `cli.outputs`, or "folder"
    setting: str = ""  # key of the settings file that gives the value if none was typed
    when: Callable[[Mapping[str, Any]], bool] = lambda values: True  # whether the setting is used
    built_in: Any = None  # value if none was typed and no setting has one
    flags: tuple[str, ...] | None = None  # spellings of an option; None for an argument


def option(text: str, metavar: str | None = None, *flags: str, **more: Any) -> Any:
    """Declare an option with its help ``text``.

    Parameters
    ----------
    flags : spellings of the option, if they do not follow from the name of its parameter.
    more : fields of `Extra`, where ``make`` is a `Make`, and parameters of typer.Option. ``names``
        is the "module:NAME" of all known values: a shell completes them, others are refused.
    """
    typer_option: Any = typer.Option  # its types take the first flag for a default
    return _declared(partial(typer_option, *flags), text, metavar, flags=flags, **more)


def argument(text: str, metavar: str, **more: Any) -> Any:
    """Declare an argument; the parameters are those of `option`."""
    return _declared(typer.Argument, text, metavar, **more)


def _declared(
    constructor: Any,
    text: str,
    metavar: str | None,
    *,
    make: Make | None = None,
    names: str = "",
    **more: Any,
) -> Any:
    """Return an option or argument of typer with its `Extra` as ``extra``."""
    if names:
        more["autocompletion"] = lambda incomplete: names_at(names)
    extra = {field.name: more.pop(field.name) for field in fields(Extra) if field.name in more}
    info = constructor(help=text, metavar=metavar, **more)
    conversion = partial(_converted, make, names) if make or names else None
    info.extra = Extra(make=conversion, **extra)
    return info


def _converted(make: Make | None, names: str, value: Any) -> Any:
    """Convert a typed value. Refuses a value that is not one of the known ``names``."""
    if names and value != []:
        known_names = names_at(names)
        if isinstance(value, list):
            value = [require_known(name, known_names) for name in value]
        else:
            value = require_known(value, known_names)
    if make is None:
        return value
    convert = _imported(make) if isinstance(make, str) else make
    return convert(value)


def _imported(place: str) -> Any:
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def names_at(place: str) -> list[str]:
    """Return the names at "module:NAME", where an iterable or a function that returns one is."""
    names = _imported(place)
    return [str(name) for name in (names() if callable(names) else names)]


def require_known(
    written: str, names: Collection[str], noun: str = "name", option: str | None = None
) -> str:
    """Return the name of ``names`` that was written, ignoring case. Refuses an unknown name.

    The message calls the name a ``noun``, typed at ``option``.
    """
    from calib.base.toml import did_you_mean

    if written in names:
        return written
    for name in names:
        if name.lower() == written.lower():
            return name
    advice = did_you_mean(written, names)
    if not advice and len(names) <= _MAX_LISTED:
        advice = f"known: {', '.join(names)}"
    problem = f"unknown {noun} {written!r}"
    raise usage_error(f"{problem}; {advice}" if advice else problem, option)


def from_settings(key: str) -> Any:
    """Return the value of a setting, None if it is not set. The file is read once in a run."""
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
    """Read a vehicle file. Refuses None."""
    from calib.car import vehicle_file

    if path is None:
        raise usage_error(f"missing; {NO_VEHICLE}")
    return vehicle_file.read_vehicle(path)


def in_si(unit: str, written: str) -> float:
    """Convert a quantity such as "60 bar" to the SI ``unit``."""
    from calib.base.errors import InputError
    from calib.base.toml import quantity

    with at_option(None, InputError):
        return quantity(written, unit, None, InputError)


def not_empty(written: str) -> str:
    """Return the text that was written. Refuses an empty text."""
    if not written.strip():
        raise usage_error("is empty")
    return written


def _version(table: str) -> str:
    """Return ``name@version`` as written. Refuses a name without a version."""
    if "@" not in table:
        raise usage_error(f"{table!r} names no version; expected {table}@N, with its number")
    return table


def limits(text: str, make: str, always: bool = True, **more: Any) -> Any:
    """Declare an option for a file of limits, which the settings may name."""
    return option(text, "L.toml", make=make, always=always, setting="limits", **more)


def channel_map(text: str = "Channel map, which may name a DBC.", **more: Any) -> Any:
    """Declare an option for a channel map."""
    return option(
        text, "M.toml", "--map", make="calib.logs.channel_map_file:read_channel_map", **more
    )


def vehicle(text: str, always: bool = False, **more: Any) -> Any:
    """Declare an option for a vehicle file."""
    return option(text, "V.toml", make=read_vehicle, always=always, **more)


Tables = Annotated[
    "Store",
    option("Folder of the tables, tables/ if not given.", "DIR", typed=Path,
           make="calib:Store", built_in=STORE, setting="store"),
]  # fmt: skip
Car = Annotated[
    "Vehicle", vehicle("Vehicle file, else that of the settings.", always=True, setting="vehicle")
]
OtherPads = Annotated[
    "Vehicle | None", vehicle("Vehicle file with other nominal pads than those of the table.")
]
Map = Annotated["ChannelMap | None", channel_map(setting="map")]
_MASS = 'Mass of the car in these logs, such as "1650 kg", if not that of the vehicle file.'
Mass = Annotated["float | None", option(_MASS, "MASS", typed=str | None, make=partial(in_si, "kg"))]
_READ_EFFECTS = "calib.car.effects.effect_file:read_own_effects"
_EFFECT = (
    "Add an effect of your own (`brake-cal manual own_effects`); may be repeated. The file is "
    "executed as Python: give only files that you trust."
)
OwnEffects = Annotated[
    "tuple[OwnEffect, ...]", option(_EFFECT, "FILE.py", typed=list[Path], make=_READ_EFFECTS)
]
StopLimits = Annotated[
    "tuple[Limit, ...]", limits("Limits that decide pass or fail.", LIMITS_OF_STOPS)
]
KnownModel = Annotated[
    Path | None, option("Model that `diagnose` wrote: its effects count as known.", "M.toml")
]
Workers = Annotated[
    int | None, option("Number of processes, else one for each core.", "N", min=1, max=512)
]
_BY = "Name of who decides, else that of the settings, or the user of this computer."
By = Annotated[str | None, option(_BY, "NAME", setting="by")]
Reason = Annotated[str, option("Reason, for the journal.", "TEXT", make=not_empty)]
TABLE = "Name, name@version or path of a version."
Table = Annotated[str, argument(TABLE, "TABLE")]
Version = Annotated[str, argument("Version: name@version.", "TABLE@N", make=_version)]
_KEY = "Public key: its file, or its text."
PublicKey = Annotated[str | None, option(_KEY, "PUBLIC", setting="keys.public")]
Required = Annotated[
    bool, option("Refuse a table without a signature that holds.", setting="require_signed")
]
SignedBy = Annotated[
    str | None,
    option(f"{_KEY} With --require-signed.", "PUBLIC", setting="keys.public",
           when=lambda values: bool(values["require_signed"])),
]  # fmt: skip

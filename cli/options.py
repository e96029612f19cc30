"""Options and arguments: how each is written, and what becomes of it.

`option` and `argument` are typer's, with `make`: what the value becomes before a command gets it.
Those that several commands share stand here once. To the type checker each is what the command
gets, to typer what is typed.
"""

import math
from collections.abc import Callable, Collection, Sequence
from datetime import date
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from calib.base.settings import STORE
from cli.console import misuse
from cli.project import from_settings

if TYPE_CHECKING:
    from calib.car.own_effects.own_effect import OwnEffect
    from calib.car.vehicle import Vehicle
    from calib.estimation.limits import Limit
    from calib.logs.channel_map import ChannelMap
    from calib.store.store import Store

READ_VEHICLE = "calib.car.vehicle_file:read_vehicle"
READ_MAP = "calib.logs.channel_map_file:read_channel_map"
NO_VEHICLE = 'give --vehicle V.toml, or write vehicle = "V.toml" into brake-cal.toml'
"""What to do where a vehicle is needed and none was named."""


Make = Callable[[Any], Any] | str
"""What a value becomes: a function, or "module:NAME" of one that is imported when it is used."""


def option(
    text: str,
    metavar: str | None = None,
    *flags: str,
    typed: Any = None,
    make: Make | None = None,
    always: bool = False,
    known: str = "",
    writes: str | None = None,
    built_in: Any = None,
    setting: str = "",
    needed: str = "",
    when: Callable[[typer.Context], bool] = lambda context: True,
    **more: Any,
) -> Any:
    """An option with its help ``text``.

    Parameters
    ----------
    flags : how it is written, if not as its parameter.
    typed : what is typed, if that is not what the command gets.
    make : what its value becomes; ``always``: of None, too.
    known : "module:NAME" of a collection of the library; its names are completed, others refused.
    writes : kind of the file that is written there, see `cli.outputs`, or "folder".
    built_in : its value where nothing else gives one.
    setting, needed, when : see `cli.project.from_settings`.
    more : for typer.
    """
    if setting:
        more["callback"] = from_settings(setting, needed, when)
    as_typer_has_it: Any = typer.Option  # to its types the first flag is a default
    made = as_typer_has_it(*flags, **_given(text, metavar, known), **more)
    return _with(made, make, known, typed, flags=flags, always=always, writes=writes,
                 built_in=built_in)  # fmt: skip


def argument(
    text: str,
    metavar: str,
    make: Make | None = None,
    known: str = "",
    typed: Any = None,
    built_in: Any = None,
    **more: Any,
) -> Any:
    """An argument; see `option`."""
    made = typer.Argument(**_given(text, metavar, known), **more)
    return _with(made, make, known, typed, always=False, built_in=built_in)


def _given(text: str, metavar: str | None, known: str) -> dict[str, Any]:
    completed = {"autocompletion": lambda incomplete: _known(known)} if known else {}
    return {"help": text, "metavar": metavar, **completed}


def _with(made: Any, make: Make | None, known: str, typed: Any = None, **extra: Any) -> Any:
    made.__dict__.update(make=_checked(make, known), typed=typed, **extra)
    return made


def _checked(make: Make | None, known: str) -> Callable[[Any], Any] | None:
    if not make and not known:
        return None

    def checked(value: Any) -> Any:
        if known:
            for one in value if isinstance(value, list) else [value]:
                require_known(one, _known(known))
        made = _named(make) if isinstance(make, str) else make
        return made(value) if made else value

    return checked


def _named(place: str) -> Any:
    module, _, name = place.partition(":")
    return getattr(import_module(module), name)


def _known(place: str) -> list[str]:
    found = _named(place)
    return [str(one) for one in (found() if callable(found) else found)]


def require_known(written: str, known: Collection[str], what: str = "") -> None:
    """Refuse a name that is not known, with the one that may be meant."""
    from calib.base.toml import did_you_mean

    if written not in known:
        near = did_you_mean(written, known)
        hint = f"{near} known:" if near else "known:"
        raise misuse(f"unknown {what}{written!r}; {hint} {', '.join(known)}")


# Tables at the Tab key: only folders of the store are read, no file of a table.


def _store_of(context: typer.Context) -> Path:
    """The store of the command line, of the settings, or the usual one."""
    given = context.params.get("store")
    if given:
        return Path(given)
    from calib.base.errors import BrakeCalError
    from calib.base.settings_file import find_project

    try:
        return find_project().settings.store or STORE
    except BrakeCalError:
        return STORE


def table_names(context: typer.Context, incomplete: str) -> list[str]:
    """Names of the tables; of one that is alone its versions as well."""
    from calib.store.folders import names_in

    begun = incomplete.partition("@")[0]
    names = [name for name in names_in(_store_of(context)) if name.startswith(begun)]
    versions = table_versions(context, incomplete) if "@" in incomplete or len(names) == 1 else []
    return versions if "@" in incomplete else [*names, *versions]


def table_versions(context: typer.Context, incomplete: str) -> list[str]:
    """``name@version`` of every table, the newest first."""
    from calib.store.folders import names_in, versions_in

    store, begun = _store_of(context), incomplete.partition("@")[0]
    names = [name for name in names_in(store) if name.startswith(begun)]
    return [f"{name}@{n}" for name in names for n in reversed(versions_in(store / name))]


# What is typed becomes what a command works with.


def _limits(path: Path) -> Any:
    from calib.estimation.limits_file import read_limits
    from calib.estimation.metrics import METRICS as OF_STOPS
    from calib.line.station.metrics import METRICS as OF_CAR

    return read_limits(path, {*OF_STOPS, *OF_CAR})


def limits_of_stops(path: Path | None) -> Any:
    """The limits of a file for single stops; the default limits without a file."""
    from calib.base.errors import LimitsError
    from calib.estimation.limits import DEFAULTS
    from calib.estimation.metrics import METRICS

    if path is None:
        return DEFAULTS
    limits = tuple(limit for limit in _limits(path) if limit.figure in METRICS)
    if not limits:
        raise LimitsError(
            "no limit for a stop", where=path, do="judge the car with `brake-cal station`"
        )
    return limits


def limits_of_car(path: Path | None) -> Any:
    """The limits of a file for a car and its stops; the default limits without a file."""
    from calib.line.station.limits_file import LIMITS

    return _limits(path) if path else LIMITS


def quantity(si: str, plain: bool = False) -> Callable[[str], float]:
    """Makes SI of a quantity as a vehicle file has it; ``plain``: or of a number that is in SI."""

    def make(written: str) -> float:
        from calib.base.errors import InputError
        from calib.base.toml import quantity

        try:
            value = float(written) if plain and _is_number(written) else math.nan
            value = quantity(written, si, None, InputError) if math.isnan(value) else value
        except InputError as error:
            raise misuse(str(error)) from None
        if not math.isfinite(value):
            raise misuse(f"{written!r} is not finite")
        return value

    return make


def _is_number(written: str) -> bool:
    try:
        return not math.isnan(float(written))
    except ValueError:
        return False


def _mass(written: str) -> float:
    """A mass [kg] within what a vehicle file may say."""
    from calib.car.keys import KEYS

    mass, known = quantity("kg")(written), next(key for key in KEYS if key.name == "mass")
    if not known.least <= mass <= known.most:
        raise misuse(
            f"{mass:g} kg is not believable; expected {known.least:g} to {known.most:g} kg"
        )
    return mass


def day(written: str) -> str:
    """A day as it was written; refuses what is none."""
    try:
        date.fromisoformat(written)
    except ValueError:
        raise misuse(f"{written!r} is not a date such as 2025-03-31") from None
    return written


def words(written: str) -> str:
    """A text that says something."""
    if not written.strip():
        raise misuse("says nothing")
    return written


def _version(table: str) -> str:
    if "@" not in table:
        raise misuse(f"{table!r} names no version; give {table}@N, see `brake-cal tables list`")
    return table


def _files(paths: Sequence[Path]) -> Sequence[Path]:
    """Logs that a table will name, so that they can be found again: none from stdin."""
    if any(str(path) == "-" for path in paths):
        raise misuse("a table names the logs that it is made of: give a file, not -")
    return paths


def logs(text: str) -> Any:
    """Argument for logs."""
    return argument(text, "LOG...")


def logs_by_name(text: str, metavar: str = "LOG...") -> Any:
    """Argument for logs that a table will name."""
    return argument(text, metavar, make=_files)


# Shared options. What is quoted is what the command gets; ``typed`` is what typer reads.

Tables = Annotated[
    "Store",
    option(
        "Directory of the tables.",
        "DIR",
        typed=Path,
        make="calib:Store",
        built_in=STORE,
        setting="store",
    ),
]
Car = Annotated[
    "Vehicle",
    option(
        "Vehicle file; else that of the settings.",
        "V.toml",
        typed=Path,
        make=READ_VEHICLE,
        default_factory=lambda: None,
        show_default=False,
        setting="vehicle",
        needed=f"missing; {NO_VEHICLE}",
    ),
]
Map = Annotated[
    "ChannelMap | None",
    option(
        "Channel map, and DBC.", "M.toml", "--map", typed=Path | None, make=READ_MAP, setting="map"
    ),
]
Mass = Annotated[
    "float | None",
    option(
        'Mass of the car in these logs, such as "1650 kg", if not that of the vehicle file.',
        "MASS",
        typed=str | None,
        make=_mass,
    ),
]
OwnEffects = Annotated[
    "tuple[OwnEffect, ...]",
    option(
        "Add an effect of your own (`brake-cal manual vehicle_file`); may be repeated. The "
        "file is executed as Python: give only files that you trust.",
        "FILE.py",
        typed=list[Path],
        make="calib.car.own_effects.effect_file:read_own_effects",
    ),
]
StopLimits = Annotated[
    "tuple[Limit, ...]",
    option(
        "Limits that decide pass or fail.",
        "L.toml",
        typed=Path | None,
        make=limits_of_stops,
        always=True,
        setting="limits",
    ),
]
OtherPads = Annotated[
    "Vehicle | None",
    option(
        "Other nominal pads than the table's; never the settings' vehicle.",
        "V.toml",
        typed=Path | None,
        make=READ_VEHICLE,
    ),
]
KnownModel = Annotated[
    Path | None, option("Model of `diagnose`, whose effects are then known.", "M.toml")
]
Workers = Annotated[int | None, option("Processes; else all cores.", "N", min=1, max=512)]
By = Annotated[
    str | None,
    option(
        "Who says so; else the person of the settings, or the user of this computer.",
        "NAME",
        setting="by",
    ),
]
Reason = Annotated[str, option("Why, for the journal.", "TEXT", make=words)]
Table = Annotated[
    str, argument("name, name@version or path of a version", "TABLE", autocompletion=table_names)
]
Version = Annotated[
    str, argument("name@version", "TABLE@N", make=_version, autocompletion=table_versions)
]
PublicKey = Annotated[
    str | None, option("Public key: its file, or its text.", "PUBLIC", setting="public_key")
]
Required = Annotated[
    bool, option("Refuse a table without a signature that holds.", None, setting="require_signed")
]
SignedBy = Annotated[
    str | None,
    option(
        "Public key that must have signed: its file, or its text.",
        "PUBLIC",
        setting="public_key",
        when=lambda asked: bool(asked.params["require_signed"]),
    ),
]

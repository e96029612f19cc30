"""Options that several commands share, each defined once, and groups of options.

An option whose help text depends on the command is a function of that text.
"""

from collections.abc import Callable
from dataclasses import is_dataclass
from functools import wraps
from inspect import Parameter, signature
from pathlib import Path
from typing import Annotated, Any, get_type_hints

import typer

from cli.completion import table_names, table_versions
from cli.project import from_settings

NO_VEHICLE = 'give --vehicle V.toml, or write vehicle = "V.toml" into brake-cal.toml'
"""What to do where a vehicle is needed and none was named."""

Store = Annotated[
    Path,
    typer.Option(
        "--store",
        metavar="DIR",
        help="Directory of the tables.",
        callback=from_settings("store"),
    ),
]


def map_file(text: str = "Channel map, and DBC.", *, callback: Any = None) -> Any:
    """Option ``--map``."""
    return typer.Option("--map", metavar="M.toml", help=text, callback=callback)


Map = Annotated[Path | None, map_file(callback=from_settings("map"))]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout.")]
KnownModel = Annotated[
    Path | None,
    typer.Option(
        "--model", metavar="M.toml", help="Model of `diagnose`, whose effects are then known."
    ),
]
Workers = Annotated[
    int | None,
    typer.Option("--workers", metavar="N", min=1, max=512, help="Processes; else all cores."),
]
OwnEffects = Annotated[
    list[Path] | None,
    typer.Option(
        "--effect",
        metavar="FILE.py",
        help="Add an effect of your own (`brake-cal manual vehicle_file`); may be repeated. The "
        "file is executed as Python: give only files that you trust.",
    ),
]
Mass = Annotated[
    str | None,
    typer.Option(
        "--mass",
        metavar="MASS",
        help='Mass of the car in these logs, such as "1650 kg", if not that of the vehicle file.',
    ),
]
By = Annotated[
    str | None,
    typer.Option(
        "--by",
        metavar="NAME",
        help="Who says so; else the person of the settings, or the user of this computer.",
        callback=from_settings("by"),
    ),
]
Reason = Annotated[str, typer.Option("--reason", metavar="TEXT", help="Why, for the journal.")]
TableVersion = Annotated[
    str,
    typer.Argument(
        metavar="TABLE",
        help="name, name@version or path of a version",
        autocompletion=table_names,
    ),
]

PublicKey = Annotated[
    str | None,
    typer.Option(
        "--key",
        metavar="PUBLIC",
        help="Public key: its file, or its text.",
        callback=from_settings("public_key"),
    ),
]

Version = Annotated[
    str,
    typer.Argument(metavar="TABLE@N", help="name@version", autocompletion=table_versions),
]


def refuse_bare(table: str) -> None:
    """Refuse a name without a version where it must be one, see `Version`."""
    if "@" not in table:
        raise typer.BadParameter(
            f"{table!r} names no version; give {table}@N, see `brake-cal tables list`",
            param_hint="TABLE@N",
        )


def vehicle_file(text: str, *, callback: Any = None) -> Any:
    """Option ``--vehicle``."""
    return typer.Option("--vehicle", metavar="V.toml", help=text, callback=callback)


def needed_vehicle(text: str = "Vehicle file") -> Any:
    """Option ``--vehicle`` of a command that needs one, from the option or from the settings."""
    return typer.Option(
        "--vehicle",
        metavar="V.toml",
        help=f"{text}; else that of the settings.",
        default_factory=lambda: None,
        show_default=False,
        callback=from_settings("vehicle", f"missing; {NO_VEHICLE}"),
    )


def limits_file(text: str, *, callback: Any = None) -> Any:
    """Option ``--limits``."""
    return typer.Option("--limits", metavar="L.toml", help=text, callback=callback)


def out_folder(text: str) -> Any:
    """Option ``--out`` of a command that writes several files."""
    return typer.Option("--out", metavar="DIR", help=text)


def out_file(text: str, metavar: str = "FILE") -> Any:
    """Option ``--out`` of a command that writes one file."""
    return typer.Option("--out", metavar=metavar, help=text)


Force = Annotated[
    bool, typer.Option("--force", help="Replace a file that exists, whatever it holds.")
]

Report = Annotated[
    Path | None, typer.Option("--report", metavar="FILE.html", help="Write one page of HTML here.")
]

VehicleFile = Annotated[Path, needed_vehicle()]


def grouped(command: Callable[..., None]) -> Callable[..., None]:
    """Allow frozen records of options as parameters of ``command``.

    A parameter whose type is a dataclass is replaced by its fields, each an option. The command is
    called with the record made of them.
    """
    hints = get_type_hints(command, include_extras=True)
    records: dict[str, Callable[..., Any]] = {
        name: hint for name, hint in hints.items() if isinstance(hint, type) and is_dataclass(hint)
    }
    options = {name: list(signature(kind).parameters) for name, kind in records.items()}

    @wraps(command)
    def run(**given: Any) -> None:
        for name, kind in records.items():
            given[name] = kind(**{option: given.pop(option) for option in options[name]})
        command(**given)

    parameters: list[Parameter] = []
    for parameter in signature(command).parameters.values():
        if parameter.name in records:
            fields = signature(records[parameter.name]).parameters.values()
            parameters += [field.replace(kind=Parameter.KEYWORD_ONLY) for field in fields]
        else:
            parameters.append(parameter.replace(annotation=hints[parameter.name]))
    vars(run)["__signature__"] = signature(command).replace(parameters=parameters)
    run.__annotations__ = {p.name: p.annotation for p in parameters}
    return run


def example(*lines: str) -> str:
    """Epilog of a command's help: ``lines`` that can be run in the folder of the demo."""
    return "\n".join(("\b", "Example:", *(f"  {line}" for line in lines)))

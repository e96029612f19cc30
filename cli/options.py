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

STORE = Path("tables")
"""Default of `Store`."""

Store = Annotated[Path, typer.Option("--store", metavar="DIR", help="Directory of the tables.")]
Map = Annotated[Path | None, typer.Option("--map", metavar="M.toml", help="Channel map, and DBC.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON document on stdout.")]
KnownModel = Annotated[
    Path | None,
    typer.Option(
        "--model", metavar="M.toml", help="Model of `diagnose`, whose effects are then known."
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
    typer.Option("--by", metavar="NAME", help="Who says so; else the user of this computer."),
]
Reason = Annotated[str, typer.Option("--reason", metavar="TEXT", help="Why, for the journal.")]
TableVersion = Annotated[
    str, typer.Argument(metavar="TABLE", help="name, name@version or path of a version")
]

PublicKey = Annotated[
    str | None,
    typer.Option("--key", metavar="PUBLIC", help="Public key: its file, or its text."),
]

Version = Annotated[str, typer.Argument(metavar="TABLE@N", help="name@version")]


def refuse_bare(table: str) -> None:
    """Refuse a name without a version where it must be one, see `Version`."""
    if "@" not in table:
        raise typer.BadParameter(
            f"{table!r} names no version; give {table}@N, see `brake-cal tables list`",
            param_hint="TABLE@N",
        )


def vehicle_file(text: str = "Vehicle file.") -> Any:
    """Option ``--vehicle``."""
    return typer.Option("--vehicle", metavar="V.toml", help=text)


def limits_file(text: str) -> Any:
    """Option ``--limits``."""
    return typer.Option("--limits", metavar="L.toml", help=text)


def out_folder(text: str) -> Any:
    """Option ``--out`` of a command that writes several files."""
    return typer.Option("--out", metavar="DIR", help=text)


def out_file(text: str, metavar: str = "FILE") -> Any:
    """Option ``--out`` of a command that writes one file."""
    return typer.Option("--out", metavar=metavar, help=text)


VehicleFile = Annotated[Path, vehicle_file()]


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

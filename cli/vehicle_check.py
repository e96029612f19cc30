"""`brake-cal vehicle check`: whether a vehicle file is valid, and whether it can be a car."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import complain, emit, emit_json, warn
from cli.options import Json, example

if TYPE_CHECKING:
    from calib.base.errors import InputError
    from calib.base.warning import PlausibilityWarning

EPILOG = example("brake-cal vehicle check sample_logs/sedan/vehicle.toml")
IMPLAUSIBLE, UNREADABLE = 1, 3

Judged = tuple[Path, str, "tuple[PlausibilityWarning, ...]", tuple[str, ...]]
"""A file, the name of its vehicle, the warnings on it, and what a person has to confirm."""

Files = Annotated[list[Path], typer.Argument(metavar="FILE...", help="vehicle files to check")]


def check(files: Files, json: Json = False) -> None:
    """Judge vehicle files: mistakes, then plausibility.

    All mistakes of a file are listed, then what no usual car has, with the likely causes, and what
    only some cars have, for you to confirm. Exit code 0 if all is plausible, 1 if a figure is
    outside its usual range, 3 if a file cannot be used. A mistake within what cars differ by, such
    as a mass that is 10 % wrong, is not seen.
    """
    from calib.base.warning import to_dict

    found, errors = _look(files)
    if json:
        vehicles = [
            {"source": path, "vehicle": name, "plausible": not warnings,
             "warnings": [to_dict(one) for one in warnings], "to_confirm": open_}
            for path, name, warnings, open_ in found
        ]  # fmt: skip
        failed = [{"source": path, "error": str(error)} for path, error in errors]
        emit_json({"schema": 1, "vehicles": vehicles, "unreadable": failed})
    else:
        for path, name, warnings, open_ in found:
            emit(f"{path}: {name}: {_verdict(len(warnings), len(open_))}")
            for sentence in open_:
                emit(f"to confirm: {sentence}")
            warn(warnings)
        for _, error in errors:
            complain(str(error))
    if errors:
        raise typer.Exit(UNREADABLE)
    if any(warnings for _, _, warnings, _ in found):
        raise typer.Exit(IMPLAUSIBLE)


def _look(files: list[Path]) -> "tuple[list[Judged], list[tuple[Path, InputError]]]":
    """Name and warnings of each file; one that cannot be used does not stop the others."""
    from calib.base.errors import InputError
    from calib.car.plausible import plausible, to_confirm
    from calib.car.vehicle_file import read_vehicle

    found, errors = [], []
    for path in files:
        try:
            vehicle = read_vehicle(path)
        except InputError as error:
            errors.append((path, error))
        else:
            found.append((path, vehicle.name, plausible(vehicle), to_confirm(vehicle)))
    return found, errors


def _verdict(warnings: int, unconfirmed: int) -> str:
    if not warnings:
        return "plausible, if you can confirm this" if unconfirmed else "plausible"
    return f"not plausible: {warnings} figure{'s' * (warnings > 1)} outside the usual range"

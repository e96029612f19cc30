"""`brake-cal vehicle init`: a vehicle file with a comment on every key."""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import emit_json, say, warn
from cli.options import Force, Json, example
from cli.outputs import refuse_folder, refuse_foreign, writing

if TYPE_CHECKING:
    from calib.car.keys import VehicleKey

EPILOG = example("brake-cal vehicle init my_car.toml --from sedan")
SEDAN = "sedan"
"""Name of the reference vehicle, the only one that can be written."""
FILE = "FILE"


def init(
    file: Annotated[Path, typer.Argument(metavar=FILE, help="Vehicle file to write.")] = Path(
        "vehicle.toml"
    ),
    start: Annotated[
        str | None,
        typer.Option("--from", metavar="NAME", help="Ask nothing: write the reference car, sedan."),
    ] = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Write a vehicle file with a comment on every key.

    The comments say unit, meaning, how to measure it, and the usual range. In a terminal it asks
    for each value; Enter takes the one in brackets, that of the reference car. A number without a
    unit has the unit of the question. Ctrl+C ends it without a file.
    """
    from calib.base.write import write_whole
    from calib.car.keys import REFERENCE, vehicle_text
    from calib.car.plausible import plausible
    from calib.car.vehicle_file import read_vehicle

    _check_usage(file, start, force)
    text = vehicle_text(_asked() if start is None else REFERENCE)
    with writing(file, FILE):
        write_whole(file, text.encode())
    say(f"wrote {file}")
    warnings = plausible(read_vehicle(file))  # two answers may contradict each other
    warn(warnings)
    if json:
        from calib.base.warning import to_dict

        emit_json({"schema": 1, "out": file, "warnings": [to_dict(one) for one in warnings]})
    say(f"next: edit it, then `brake-cal vehicle check {file}`")


def _check_usage(file: Path, start: str | None, force: bool) -> None:
    from calib.car.keys import REFERENCE, vehicle_text

    refuse_folder(file, FILE)
    unedited = vehicle_text(REFERENCE).encode()
    refuse_foreign(file, lambda data: data == unedited, "the reference car's file", force, FILE)
    if start is not None and start != SEDAN:
        raise typer.BadParameter(f"unknown vehicle {start!r}; known: {SEDAN}", param_hint="--from")
    if start is None and not can_ask():
        raise typer.BadParameter(
            f"without a terminal nothing can be asked; --from {SEDAN} writes a file to edit",
            param_hint="--from",
        )


def can_ask() -> bool:
    """Whether somebody sits at a terminal."""
    return sys.stdin.isatty()


def _asked() -> Mapping[str, str]:
    """The value of every key, as it will stand in the file."""
    from calib.car.keys import KEYS

    say("Enter takes the value in brackets, that of the reference car; Ctrl+C ends without a file")
    values: dict[str, str] = {}
    section = ""
    for number, key in enumerate(KEYS, start=1):
        if key.section != section:
            section = key.section
            say(f"\n[{section}]" + ("" if section == "chassis" else ": values of one wheel"))
        say(f"\n{number}/{len(KEYS)}  {key.name}: {key.meaning}")
        say(f"       how: {key.measure}" + (f"; usual: {key.usual}" if key.usual else ""))
        values[key.path] = _one(key, values)
    return values


def _one(key: "VehicleKey", before: Mapping[str, str]) -> str:
    """One answer; what cannot be used is asked again."""
    from calib.base.errors import VehicleError
    from calib.car.keys import default_of
    from calib.car.vehicle_file import answered

    label = f"{key.name} in {key.unit}" if key.unit not in ("", "1") else key.name
    while True:
        typed = typer.prompt(label, default=default_of(key, before), err=True)
        try:
            return answered(key, typed)
        except VehicleError as error:
            say(f"  {error}")

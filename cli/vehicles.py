"""`brake-cal vehicle`: write a vehicle file, judge one, show what follows from it."""

import sys
from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING

import typer

from cli.command import FAILED, UNREADABLE, Answer, add, command, group
from cli.console import complain, misuse, say, this_run, warn
from cli.options import argument, option
from cli.outputs import check_file, refuse_foreign, write_file

if TYPE_CHECKING:
    from calib.car.keys import VehicleKey

SEDAN = "sedan"
"""Name of the reference vehicle, the only one that can be written."""


@command("brake-cal vehicle init my_car.toml --from sedan")
def init(
    file: Path = argument("Vehicle file to write.", "FILE", built_in=Path("vehicle.toml")),
    *,
    start: str | None = option("Ask nothing: write the reference car, sedan.", "NAME", "--from"),
    force: bool = option("Replace a file that exists, whatever it holds."),
) -> Answer:
    """Write a vehicle file with a comment on every key.

    The comments say unit, meaning, how to measure it, and the usual range. In a terminal it asks
    for each value; Enter takes the one in brackets, that of the reference car. A number without a
    unit has the unit of the question. Ctrl+C ends it without a file.
    """
    from calib.base.warning import to_dict
    from calib.car.keys import REFERENCE, vehicle_text
    from calib.car.plausible import plausible
    from calib.car.vehicle_file import read_vehicle

    this_run().inputs, this_run().force = {}, force
    check_file(file, option="FILE")
    unedited = vehicle_text(REFERENCE).encode()
    refuse_foreign(file, unedited.__eq__, "FILE")
    if start is not None and start != SEDAN:
        raise misuse(f"unknown vehicle {start!r}; known: {SEDAN}", "--from")
    if start is None and not sys.stdin.isatty():
        raise misuse(
            f"without a terminal nothing can be asked; --from {SEDAN} writes a file to edit",
            "--from",
        )
    text = vehicle_text(_asked() if start is None else REFERENCE).encode()
    this_run().force |= text != unedited  # it was checked before the questions
    write_file(file, text, "FILE")
    warnings = plausible(read_vehicle(file))  # two answers may contradict each other
    warn(warnings)
    say(f"next: edit it, then `brake-cal vehicle check {file}`")
    return Answer({"out": file, "warnings": [to_dict(one) for one in warnings]})


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


@command("brake-cal vehicle check sample_logs/sedan/vehicle.toml")
def check(files: list[Path] = argument("vehicle files to check", "FILE...")) -> Answer:
    """Judge vehicle files: mistakes, then plausibility.

    All mistakes of a file are listed, then what no usual car has, with the likely causes, and what
    only some cars have, for you to confirm. Exit code 0 if all is plausible, 1 if a figure is
    outside its usual range, 3 if a file cannot be used. A mistake within what cars differ by, such
    as a mass that is 10 % wrong, is not seen.
    """
    from calib.base.errors import InputError
    from calib.base.plain import counted
    from calib.base.warning import to_dict
    from calib.car.plausible import plausible, to_confirm
    from calib.car.vehicle_file import read_vehicle

    found, failed, lines = [], [], []
    for path in files:
        try:
            car = read_vehicle(path)
        except InputError as error:
            failed.append({"source": path, "error": str(error)})
            complain(str(error))
            continue
        warnings, open_ = plausible(car), to_confirm(car)
        warn(warnings)
        told = {"warnings": [to_dict(one) for one in warnings], "to_confirm": open_}
        found.append({"source": path, "vehicle": car.name, "plausible": not warnings, **told})
        verdict = "plausible, if you can confirm this" if open_ else "plausible"
        if warnings:
            verdict = f"not plausible: {counted(len(warnings), 'figure')} outside the usual range"
        lines += [f"{path}: {car.name}: {verdict}", *(f"to confirm: {one}" for one in open_)]
    implausible = FAILED * any(not one["plausible"] for one in found)
    code = UNREADABLE if failed else implausible
    return Answer({"vehicles": found, "unreadable": failed}, "\n".join(lines), code)


@command(
    "brake-cal vehicle show sample_logs/sedan/vehicle.toml",
    "brake-cal vehicle show sample_logs/sedan/vehicle.toml --plot brakes.png",
)
def show(
    file: Path = argument("vehicle file", "FILE"),
    *,
    plot: Path | None = option("Draw it: .png, .svg or .pdf.", "FILE", writes="picture"),
) -> Answer:
    """Show what follows from a vehicle file.

    Loads, torque per bar, distribution of the brake force, and which axle locks first. With the
    nominal pads, in a straight line, one pressure on both axles, without drag. The schema of --json
    is printed by `brake-cal schema vehicle-facts`.
    """
    from calib.car.facts_file import facts_document
    from calib.car.vehicle_file import read_vehicle
    from calib.show.sheet import render
    from calib.show.vehicle import facts, sheet

    car = read_vehicle(file)
    if plot is not None:
        write_file(plot, render(sheet(car).overview(), plot.suffix.lower()), "--plot")
    return Answer(facts_document(car).model_dump(by_alias=True), facts(car))


app = group(
    "vehicle",
    "Vehicle files: write one, judge one, see what follows.",
    "brake-cal vehicle check sample_logs/sedan/vehicle.toml",
)
add(app, "Commands", init, check, show)

"""`brake-cal vehicle`: write a vehicle file, check it, show what follows from it."""

from pathlib import Path

from cli.command import FAILED, UNREADABLE, Answer, command
from cli.console import print_error, print_warnings, say
from cli.groups import add, group
from cli.options import argument, option
from cli.outputs import write_file


@command("brake-cal vehicle init my_car.toml")
def init(
    file: Path = argument("File to write.", "FILE", built_in=Path("vehicle.toml"), writes=""),
) -> Answer:
    """Write a vehicle file with a comment on every key.

    A comment says the meaning of a key, its unit, how to measure it, and the usual range. The
    values are those of the reference car.
    """
    from calib.car.keys import vehicle_text

    write_file(file, vehicle_text().encode(), "FILE")
    say(f"next: edit it, then `brake-cal vehicle check {file}`")
    return Answer({"out": file, "warnings": []})


@command("brake-cal vehicle check sample_logs/sedan/vehicle.toml")
def check(files: list[Path] = argument("Vehicle files to check.", "FILE...")) -> Answer:
    """Judge vehicle files: mistakes, then plausibility.

    All mistakes of a file are listed, then what no usual car has. Exit code 0 if all files are
    plausible, 1 if a figure is outside its usual range, 3 if a file cannot be used.
    """
    from calib.base.errors import InputError
    from calib.base.plain import counted
    from calib.base.warning import to_dict
    from calib.car.plausible import vehicle_warnings
    from calib.car.vehicle_file import read_vehicle

    judged, unreadable, lines = [], [], []
    for path in files:
        try:
            car = read_vehicle(path)
        except InputError as error:
            unreadable.append({"source": path, "error": str(error)})
            print_error(str(error))
            continue
        warnings = vehicle_warnings(car)
        print_warnings(warnings)
        count = counted(len(warnings), "figure")
        verdict = f"not plausible: {count} outside the usual range" if warnings else "plausible"
        details = {"plausible": not warnings, "warnings": list(map(to_dict, warnings))}
        judged.append({"source": path, "vehicle": car.name, **details})
        lines.append(f"{path}: {car.name}: {verdict}")
    code = 0 if all(entry["plausible"] for entry in judged) else FAILED
    document = {"vehicles": judged, "unreadable": unreadable}
    return Answer(document, "\n".join(lines), UNREADABLE if unreadable else code)


@command(
    "brake-cal vehicle show sample_logs/sedan/vehicle.toml",
    "brake-cal vehicle show sample_logs/sedan/vehicle.toml --plot brakes.png",
)
def show(
    file: Path = argument("Vehicle file.", "FILE"),
    *,
    plot: Path | None = option("Draw it into a .png, .svg or .pdf.", "FILE", writes="picture"),
) -> Answer:
    """Show what follows from a vehicle file.

    These are loads, torque per bar, share of the front axle, and the deceleration up to which the
    front axle locks first: with nominal pads, one pressure on both axles, straight on, no drag.
    """
    from calib.base.warning import to_dict
    from calib.car.characteristics import characteristics
    from calib.car.plausible import vehicle_warnings
    from calib.car.vehicle_file import read_vehicle
    from calib.show.sheet import render
    from calib.show.vehicle import vehicle_sheet

    car = read_vehicle(file)
    if plot is not None:
        write_file(plot, render(vehicle_sheet(car).overview(), plot.suffix.lower()), "--plot")
    warnings = [to_dict(warning) for warning in vehicle_warnings(car)]
    return Answer({"name": car.name, "facts": characteristics(car), "warnings": warnings}, car)


vehicle = group(
    "vehicle",
    "Vehicle files: write one, judge one, see what follows.",
    "brake-cal vehicle check sample_logs/sedan/vehicle.toml",
)
add(vehicle, "Commands", init, check, show)

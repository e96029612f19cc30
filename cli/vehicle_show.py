"""`brake-cal vehicle show`: what follows from a vehicle file."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import emit, emit_json, say, warn
from cli.grid import facts_grid, grid
from cli.options import Force, Json, example
from cli.outputs import refuse_no_picture, refuse_overwriting, writing

if TYPE_CHECKING:
    from rich.table import Table as Grid

    from calib.car.facts_file import VehicleFacts
    from calib.car.vehicle import Vehicle

EPILOG = example(
    "brake-cal vehicle show sample_logs/sedan/vehicle.toml",
    "brake-cal vehicle show sample_logs/sedan/vehicle.toml --plot brakes.png",
)
PLOT = "--plot"


def show(
    file: Annotated[Path, typer.Argument(metavar="FILE", help="vehicle file")],
    picture: Annotated[
        Path | None,
        typer.Option(PLOT, metavar="FILE", help="Draw it: .png, .svg or .pdf."),
    ] = None,
    force: Force = False,
    json: Json = False,
) -> None:
    """Show what follows from a vehicle file.

    Loads, torque per bar, distribution of the brake force, and which axle locks first. With the
    nominal pads, in a straight line, one pressure on both axles, without drag. The schema of --json
    is printed by `brake-cal schema vehicle-facts`.
    """
    if picture is not None:
        refuse_no_picture(picture, force, PLOT)
        refuse_overwriting([picture], [], [file], PLOT)
    from calib.car.facts_file import facts_document, what_follows
    from calib.car.plausible import plausible
    from calib.car.vehicle_file import read_vehicle

    vehicle = read_vehicle(file)
    warn(plausible(vehicle))
    if picture is not None:
        _draw(vehicle, picture)
    if json:
        emit_json(facts_document(vehicle).model_dump(by_alias=True))
        return
    facts = what_follows(vehicle)
    emit(f"{vehicle.name}, {vehicle.mass:g} kg")
    for part in (_figures(facts), _axles(facts), _distribution(facts), _locks(facts)):
        emit(part)
        emit("")


def _draw(vehicle: "Vehicle", picture: Path) -> None:
    from calib.show.sheet import save
    from calib.show.vehicle import sheet

    with writing(picture, PLOT):
        save({picture: [sheet(vehicle).overview()]})
    say(f"wrote {picture}")


def _figures(facts: "VehicleFacts") -> "Grid":
    biased = facts.front_biased_up_to
    words = {None: "front always", 0.0: "rear always"}
    rows = facts_grid()
    rows.add_row("wheelbase", f"{1e3 * facts.wheelbase:.0f} mm")
    rows.add_row("pressure", f"{facts.pressure_per_g:.1f} bar per g")
    rows.add_row("brake force", f"{100 * facts.front_share:.1f} % front")
    rows.add_row("locks first", words.get(biased) or f"front up to {biased:.2f} g, rear above")
    rows.add_row("rear lifts at", f"{facts.rear_lifts_at:.2f} g")
    return rows


def _axles(facts: "VehicleFacts") -> "Grid":
    rows = grid("axle", "front", "rear", right=("front", "rear"))
    for name, key, digits in (
        ("torque per bar, one wheel [N m]", "torque_per_bar_wheel", 2),
        ("torque per bar, axle [N m]", "torque_per_bar_axle", 2),
        ("load at rest [kg]", "static_load", 0),
        ("load at 0.5 g [kg]", "load_at_half_g", 0),
        ("mass of a wheel at its radius [kg]", "wheel_mass", 1),
    ):
        rows.add_row(name, *(f"{getattr(a, key):.{digits}f}" for a in (facts.front, facts.rear)))
    return rows


def _distribution(facts: "VehicleFacts") -> "Grid":
    heads = ("pressure [bar]", "front [%]", "ideal [%]", "friction front", "friction rear",
             "torque front [N m]", "torque rear [N m]")  # fmt: skip
    rows = grid("g", *heads, right=("g", *heads))
    for b in facts.distribution:
        rows.add_row(
            f"{b.deceleration:.1f}",
            f"{b.pressure:.1f}",
            f"{100 * b.front_share:.1f}",
            f"{100 * b.ideal_front_share:.1f}",
            *("lifted" if x is None else f"{x:.2f}" for x in (b.friction_f, b.friction_r)),
            f"{b.torque_f:.0f}",
            f"{b.torque_r:.0f}",
        )
    return rows


def _locks(facts: "VehicleFacts") -> "Grid":
    rows = grid("road friction", "locks first", "at [g]", "at [bar]", right=("at [g]", "at [bar]"))
    for lock in facts.first_lock:
        rows.add_row(
            f"{lock.friction:.1f}", lock.axle, f"{lock.deceleration:.2f}", f"{lock.pressure:.0f}"
        )
    return rows

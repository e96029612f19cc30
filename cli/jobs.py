"""What is done with each of many logs, as `batch` and `watch` are told it."""

from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

if TYPE_CHECKING:
    from calib.fleet.job import Job
    from calib.validation.limits import Limit


class Command(StrEnum):
    """What can be done with many logs."""

    FIT = "fit"
    VALIDATE = "validate"
    CHECK = "check"
    DIAGNOSE = "diagnose"


def _command(written: str) -> Command:
    from calib.toml import did_you_mean

    known = [str(command) for command in Command]
    if written not in known:
        near = did_you_mean(written, known)
        told = f"{written!r} is not one of {', '.join(known)}"
        raise typer.BadParameter(f"{told}; {near}" if near else told)
    return Command(written)


Commands = Annotated[
    Command,
    typer.Argument(
        parser=_command,
        metavar="COMMAND",
        help="What to do with each log.",
    ),
]
Out = Annotated[
    Path, typer.Option("--out", metavar="DIR", help="Write results.parquet and journal here.")
]
Workers = Annotated[
    int | None, typer.Option(metavar="N", min=1, max=512, help="Processes; else all cores.")
]
Table = Annotated[
    str | None, typer.Option(metavar="TABLE", help="validate: name, name@version or path.")
]
VehicleFile = Annotated[
    Path | None, typer.Option(metavar="V.toml", help="fit, validate: vehicle file.")
]
Limits = Annotated[
    Path | None, typer.Option(metavar="L.toml", help="validate: limits for pass or fail.")
]
Fresh = Annotated[
    bool, typer.Option("--fresh", help="Throw away what DIR of --out holds and begin anew.")
]


def job_of(
    command: Command,
    out: Path,
    table: str | None,
    store: Path,
    vehicle: Path | None,
    limits: Path | None,
    channel_map: Path | None,
) -> "Job":
    """Read once what every log needs. Refuse what is missing, and what would be left unused."""
    _check_usage(command, out, table, vehicle, limits)
    from calib.fleet.job import Job
    from calib.logs.channel_map_file import read_channel_map
    from calib.physics.vehicle_file import read_vehicle
    from calib.table.store import load
    from calib.validation.validate import require_same_vehicle

    known = load(table, store).table if table else None
    car = read_vehicle(vehicle) if vehicle else None
    if known is not None:
        require_same_vehicle(known, car, vehicle)
    return Job(
        command=command.value,
        table=known,
        vehicle=car,
        limits=limits_of_stops(limits) if command is Command.VALIDATE else (),
        channel_map=read_channel_map(channel_map) if channel_map else None,
    )


def limits_of_stops(path: Path | None) -> "tuple[Limit, ...]":
    """The limits of a file that hold for single stops; by default where there is no file."""
    from calib.errors import LimitsError
    from calib.station.metrics import METRICS as OF_CAR
    from calib.validation.limits import DEFAULTS
    from calib.validation.limits_file import read_limits
    from calib.validation.metrics import METRICS

    if path is None:
        return DEFAULTS
    limits = tuple(x for x in read_limits(path, {*METRICS, *OF_CAR}) if x.figure in METRICS)
    if not limits:
        raise LimitsError(
            "no limit for a stop", where=path, do="judge the car with `brake-cal station`"
        )
    return limits


def _check_usage(
    command: Command, out: Path, table: str | None, vehicle: Path | None, limits: Path | None
) -> None:
    if command is Command.VALIDATE and table is None:
        raise typer.BadParameter("validate needs a table", param_hint="--table")
    if command is Command.FIT and vehicle is None:
        raise typer.BadParameter("fit needs a vehicle file", param_hint="--vehicle")
    of = {
        "--table": (table, (Command.VALIDATE,)),
        "--limits": (limits, (Command.VALIDATE,)),
        "--vehicle": (vehicle, (Command.FIT, Command.VALIDATE)),
    }
    for name, (value, takes) in of.items():
        if value is not None and command not in takes:
            raise typer.BadParameter(f"{command.value} takes none", param_hint=name)
    if out.exists() and not out.is_dir():
        raise typer.BadParameter(f"{out} is a file", param_hint="--out")

"""The job of `batch` and `watch`: the command for each log, and its options."""

from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from calib.line.fleet.rows import Command
from cli.completion import names_of, table_names
from cli.inputs import channel_map_of, limits_of_stops, tables_of, vehicle_of
from cli.options import NO_VEHICLE, Map, Store, limits_file, out_folder, vehicle_file
from cli.outputs import ready_folder
from cli.project import STORE, from_settings

if TYPE_CHECKING:
    from calib.line.fleet.work import Job


def _command(written: str) -> Command:
    from calib.base.toml import did_you_mean

    known = [str(command) for command in Command]
    if written not in known:
        near = did_you_mean(written, known)
        refusal = f"{written!r} is not one of {', '.join(known)}"
        raise typer.BadParameter(f"{refusal}; {near}" if near else refusal)
    return Command(written)


Commands = Annotated[
    Command,
    typer.Argument(
        parser=_command,
        metavar="COMMAND",
        autocompletion=names_of("calib.line.fleet.rows", "Command"),
        help="What to do with each log.",
    ),
]


def _is(command: Command) -> Callable[[typer.Context], bool]:
    """Whether the job is ``command``; an argument is read before options that are not given."""
    return lambda context: context.params.get("command") is command


Out = Annotated[Path, out_folder("Write results.parquet and journal here.")]
Fresh = Annotated[
    bool, typer.Option("--fresh", help="Delete the results in DIR of --out and start again.")
]


@dataclass(frozen=True)
class JobOptions:
    """Inputs of a command on many logs."""

    table: Annotated[
        str | None,
        typer.Option(
            "--table",
            metavar="TABLE",
            help="validate: name, name@version or path.",
            autocompletion=table_names,
        ),
    ] = None
    store: Store = STORE
    vehicle: Annotated[
        Path | None,
        vehicle_file(
            "fit, validate: vehicle file; of the settings for fit only.",
            callback=from_settings("vehicle", when=_is(Command.FIT)),
        ),
    ] = None
    limits: Annotated[
        Path | None,
        limits_file(
            "validate: limits for pass or fail.",
            callback=from_settings("limits", when=_is(Command.VALIDATE)),
        ),
    ] = None
    channel_map: Map = None

    def job(self, command: Command, out: Path) -> "Job":
        """Read the inputs once for all logs. Refuse missing inputs and those that are not used."""
        self._check(command)
        from calib.estimation.validate import require_same_vehicle
        from calib.line.fleet.results import NAME
        from calib.line.fleet.work import Job

        ready_folder(out, (NAME,))
        known = tables_of(self.store, [self.table])[0].table if self.table else None
        car = vehicle_of(self.vehicle)
        if known is not None:
            require_same_vehicle(known, car, self.vehicle)
        return Job(
            command=command,
            table=known,
            vehicle=car,
            limits=limits_of_stops(self.limits) if command is Command.VALIDATE else (),
            channel_map=channel_map_of(self.channel_map),
        )

    def _check(self, command: Command) -> None:
        if command is Command.VALIDATE and self.table is None:
            raise typer.BadParameter("validate needs a table", param_hint="--table")
        if command is Command.FIT and self.vehicle is None:
            raise typer.BadParameter(f"fit needs a vehicle; {NO_VEHICLE}", param_hint="--vehicle")
        of = {
            "--table": (self.table, (Command.VALIDATE,)),
            "--limits": (self.limits, (Command.VALIDATE,)),
            "--vehicle": (self.vehicle, (Command.FIT, Command.VALIDATE)),
        }
        for name, (value, takes) in of.items():
            if value is not None and command not in takes:
                raise typer.BadParameter(f"{command.value} takes none", param_hint=name)

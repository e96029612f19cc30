"""The command line: one app, the commands by name, one place where errors become exit codes."""

import os
import sys
from typing import Annotated, Any

import typer
from typer.core import TyperGroup

from calib import __version__
from calib.errors import BrakeCalError
from cli import (
    batch,
    check,
    demo,
    diagnose,
    effects,
    fit,
    fleet,
    limits,
    log,
    maps,
    plot,
    qualify,
    repeatability,
    schema,
    settings,
    simulate,
    station,
    tables,
    validate,
    vehicles,
    watch,
)
from cli.console import complain
from cli.options import example

PIPE_CLOSED = 141
"""Exit code of a program that SIGPIPE ended, as in a shell."""


class Commands(TyperGroup):
    """The group of commands; it ends without a message when the reader of its output closes."""

    def invoke(self, ctx: Any) -> Any:
        """Run the command, and flush its output while an error can still be handled."""
        try:
            result = super().invoke(ctx)
            sys.stdout.flush()
        except BrokenPipeError:
            # The interpreter flushes once more at exit; this discards it.
            os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())
            raise typer.Exit(PIPE_CLOSED) from None
        return result


# Plain help: typer's boxes import rich, which takes half of the time that --help may take.
app = typer.Typer(
    name="brake-cal",
    cls=Commands,
    rich_markup_mode=None,
    add_completion=False,
    pretty_exceptions_enable=False,
    no_args_is_help=True,
    context_settings={"help_option_names": ["-h", "--help"]},
    epilog=example("brake-cal demo", "brake-cal tables list"),
)
app.command(epilog=check.EPILOG)(check.check)
app.command(epilog=fit.EPILOG)(fit.fit)
app.command(epilog=validate.EPILOG)(validate.validate)
app.command(epilog=station.EPILOG)(station.station)
app.command(epilog=plot.EPILOG)(plot.plot)
app.command(epilog=simulate.EPILOG)(simulate.simulate)
app.command(epilog=diagnose.EPILOG, cls=diagnose.Greedy)(diagnose.diagnose)
app.command(epilog=effects.EPILOG)(effects.effects)
app.command(epilog=schema.EPILOG)(schema.schema)
app.command(epilog=settings.EPILOG)(settings.settings)
app.command(epilog=repeatability.EPILOG)(repeatability.repeatability)
app.command(epilog=batch.EPILOG)(batch.batch)
app.command(epilog=watch.EPILOG)(watch.watch)
app.command(epilog=demo.EPILOG)(demo.demo)
app.command(epilog=qualify.EPILOG)(qualify.qualify)
app.add_typer(vehicles.app, name="vehicle")
app.add_typer(log.app, name="log")
app.add_typer(maps.app, name="map")
app.add_typer(tables.app, name="tables")
app.add_typer(fleet.app, name="fleet")
app.add_typer(limits.app, name="limits")


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"brake-cal {__version__}")
        raise typer.Exit


@app.callback()
def options(
    version: Annotated[
        bool,
        typer.Option(
            "--version", callback=_print_version, is_eager=True, help="Print the version."
        ),
    ] = False,
) -> None:
    """Calibrate and validate a brake-torque estimator from one ramped braking run."""


def main() -> None:
    """Run the command line; the only place that turns a BrakeCalError into an exit code.

    typer ends usage errors with 2 and an interrupt with 130.
    """
    for library in ("OPENBLAS", "OMP", "MKL"):
        # arrays are small here: threads of the linear algebra take more time than they save
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    try:
        app(prog_name="brake-cal")
    except BrakeCalError as error:
        complain(str(error))
        sys.exit(error.exit_code)


if __name__ == "__main__":
    main()

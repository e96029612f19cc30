"""The command line: one app, the commands by name, one place where errors become exit codes."""

import os
import sys
import time
from collections.abc import Sequence
from typing import Annotated, Any

import typer

from calib.base.errors import BrakeCalError
from calib.base.program import PROGRAM
from cli import (
    batch,
    check,
    demo,
    diagnose,
    doctor,
    effects,
    fit,
    fleet,
    limits,
    log,
    manual,
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
from cli.completion import VARIABLE, answer
from cli.console import complain, emit_json, say
from cli.failure import document_of, usage_document
from cli.group import Group
from cli.loudness import begin, this_run
from cli.options import example
from cli.streams import delivered

UsageError: Any = typer.BadParameter.__base__
"""What typer raises for a wrong command line; it exports only the one for a wrong value."""

# Plain help: typer's boxes import rich, which takes half of the time that --help may take.
app = typer.Typer(
    name="brake-cal",
    cls=Group,
    rich_markup_mode=None,
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
app.command(epilog=doctor.EPILOG)(doctor.doctor)
app.command(epilog=qualify.EPILOG)(qualify.qualify)
app.command(epilog=manual.EPILOG)(manual.manual)
app.add_typer(vehicles.app, name="vehicle")
app.add_typer(log.app, name="log")
app.add_typer(maps.app, name="map")
app.add_typer(tables.app, name="tables")
app.add_typer(fleet.app, name="fleet")
app.add_typer(limits.app, name="limits")


def _print_version(wanted: bool) -> None:
    if wanted:
        typer.echo(PROGRAM)
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
    """Calibrate and validate a brake-torque estimator from one ramped braking run.

    Exit codes: 0 done or passed; 1 it ran, and the result fails its limits; 2 usage; 3 bad input; 4
    the store or a table is damaged or refused; 5 the answer could not be written.
    """


def main() -> None:
    """Run the command line; the only place that turns errors into messages and exit codes."""
    for library in ("OPENBLAS", "OMP", "MKL"):
        # arrays are small here: threads of the linear algebra take more time than they save
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    begin()
    sys.exit(delivered(_run))


def _run() -> int:
    """Exit code of what was asked on the command line, by a person or by a shell at the Tab key."""
    started = time.monotonic()
    if os.environ.get(VARIABLE) == "complete_bash":
        return answer(lambda: app(prog_name="brake-cal"))
    code = _code(sys.argv[1:])
    if this_run().verbose:
        say(f"took {time.monotonic() - started:.1f} s, exit code {code}")
    return code


def _code(words: Sequence[str]) -> int:
    """Exit code of a command line; an interrupt gives 130."""
    try:
        return app(prog_name="brake-cal", standalone_mode=False) or 0
    except BrakeCalError as error:
        _fail(words, document_of(error))
        complain(str(error))
        return error.exit_code
    except UsageError as error:
        _fail(words, usage_document(error))
        error.show()
        return int(error.exit_code)
    except typer.Abort:
        complain("stopped")
        return 1


def _fail(words: Sequence[str], document: dict[str, object]) -> None:
    """Print the error as JSON where it was asked for and no document is there yet."""
    asked = words[: words.index("--")] if "--" in words else words
    if "--json" in asked and not this_run().documents:
        emit_json(document)


if __name__ == "__main__":
    main()

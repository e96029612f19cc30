"""The command line: one app, the commands by subject, one place where errors become exit codes."""

import os
import sys
import time
from collections.abc import Sequence
from typing import Annotated, Any

import typer

from calib.base.errors import BrakeCalError
from calib.base.program import PROGRAM
from cli import tables, vehicles
from cli.check import check
from cli.command import Quiet, Verbose, add, group
from cli.console import begin, complain, emit_json, say, this_run
from cli.diagnose import Greedy, diagnose
from cli.fit import fit
from cli.log import log
from cli.machine import demo, doctor, qualify
from cli.many import batch, fleet, watch
from cli.maps import map_
from cli.plot import plot
from cli.reference import effects, manual, schema, settings
from cli.repeatability import repeatability
from cli.simulate import simulate
from cli.station import limits, station
from cli.streams import delivered
from cli.validate import validate

UsageError: Any = typer.BadParameter.__base__
"""What typer raises for a wrong command line; it exports only the one for a wrong value."""

app = group(
    "brake-cal",
    "Calibrate and validate a brake-torque estimator from one ramped braking run.",
    "brake-cal demo",
    "brake-cal tables list",
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)
add(app, "One car", check, fit, validate, plot)
add(app, "Tables", tables.app)
add(app, "The line", station, limits, repeatability, batch, watch, fleet)
add(app, "Where model and car disagree", diagnose, cls=Greedy)
add(app, "Where model and car disagree", simulate, effects)
add(app, "Files and settings", vehicles.app, log, map_, settings, schema)
add(app, "Help", demo, manual, doctor, qualify)


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
    quiet: Quiet = False,
    verbose: Verbose = False,
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
    started = time.monotonic()
    code = _code(sys.argv[1:])
    if this_run().verbose:
        say(f"took {time.monotonic() - started:.1f} s, exit code {code}")
    return code


def _code(words: Sequence[str]) -> int:
    """Exit code of a command line; an interrupt gives 130."""
    try:
        return app(prog_name="brake-cal", standalone_mode=False) or 0
    except BrakeCalError as error:
        _fail(words, error.to_dict())
        complain(str(error))
        return error.exit_code
    except UsageError as error:
        _fail(words, _usage(error))
        error.show()
        return int(error.exit_code)
    except typer.Abort:
        complain("stopped")
        return 1


def _fail(words: Sequence[str], error: dict[str, Any]) -> None:
    """Print the error as JSON where it was asked for and no document is there yet."""
    asked = words[: words.index("--")] if "--" in words else words
    if "--json" in asked and not this_run().documents:
        emit_json({"schema": 1, "error": error})


def _usage(error: Any) -> dict[str, Any]:
    """A wrong command line as the errors of the library are, see `calib.base.record`."""
    command = error.ctx.command_path if error.ctx else "brake-cal"
    hint = getattr(error, "param_hint", None) or ""
    return {
        "kind": "usage",
        "message": error.format_message(),
        "exit_code": error.exit_code,
        "what": error.message,
        "where": hint if isinstance(hint, str) else " ".join(hint),
        "expected": "",
        "do": f"see `{command} --help`",
        "lines": (),
    }


if __name__ == "__main__":
    main()

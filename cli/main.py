"""The command line: its commands by subject, and the exit codes of their errors."""

import gc
import os
import signal
import sys
from importlib import import_module
from itertools import takewhile
from typing import Annotated, Any

import typer

from calib.base.errors import BrakeCalError, UsageError, program_failure
from calib.base.names import PROGRAM
from cli.console import STOP_SIGNALS, begin_run, print_error, print_json, say, this_run
from cli.groups import Group, Row, add, group
from cli.streams import NotWritten, delivered

_UsageError: Any = typer.BadParameter.__base__  # for a wrong command line; typer does not export it

_SUBJECTS = {
    "One car": {
        "plan:plan": "Say which runs make the torque better known, before they are driven",
        "log:check": "Say for what each log can be used, without a vehicle file",
        "fit:fit": "Make the look-up table of a car from ramped brakings",
        "validate:validate": "Run the estimator with a table on other logs, and judge it",
        "plot:plot": "Draw tables, logs and results",
    },
    "Tables": {"tables:tables": "Look at tables, release or reject them, hand them out"},
    "The line": {
        "station:station": "Fit, validate and judge one car at the end of the line",
        "station:limits": "Write a file of all limits, ready to be edited",
        "station:repeatability": "Judge the calibration as a gauge, from repeated ramps",
        "many:batch": "Run one command on many logs, one row per log",
        "many:watch": "Process each log that appears in a folder, until stopped",
        "many:fleet": "Show what stands apart in a batch, or the last cars of a station",
    },
    "Where model and car disagree": {
        "diagnose:diagnose": "Name the effect that the model of a car lacks",
        "simulate:simulate": "Drive a model of a car by the pressure of a log or a manoeuvre",
        "reference:effects": "List the effects that a model can have",
    },
    "Files and settings": {
        "log:log": "Show, draw, cut or convert logs",
        "maps:map_": "Propose a channel map for a log with other names",
        "reference:settings": "Show each setting, its value and where it comes from",
        "reference:schema": "Print the JSON Schema of a file or a document",
        "vehicles:vehicle": "Vehicle files: write one, judge one, see what follows",
    },
    "Help": {
        "machine:demo": "Try the program on the sample logs, in about half a minute",
        "reference:manual": "Show the pages of the manual, one of them, or what a code means",
        "machine:qualify": "Say whether the program works on this machine",
    },
}
"""Commands by subject: the place "MODULE:FUNCTION", and the first sentence of the help."""


def _name_at(place: str) -> str:
    return place.partition(":")[2].rstrip("_")


_ROWS = [
    Row(subject, _name_at(place), summary)
    for subject, summaries in _SUBJECTS.items()
    for place, summary in summaries.items()
]
_PLACES = {_name_at(place): place for summaries in _SUBJECTS.values() for place in summaries}


class Commands(Group):
    """The commands of the program. Each is imported when it is typed."""

    def rows(self) -> list[Row]:
        """Return every command in the order of the help."""
        return _ROWS

    def get_command(self, ctx: Any, name: str) -> Any:
        """Return the command of a name, None for an unknown name; ``explain`` is ``manual``."""
        name = "manual" if name == "explain" else name
        wanted = [name] if name in _PLACES else [*_PLACES]  # all: typer can then suggest one
        for known in wanted:
            if known not in self.commands:
                self.commands[known] = _load(known)
        return super().get_command(ctx, name)


def _load(name: str) -> Any:
    module, _, attribute = _PLACES[name].partition(":")
    declared = getattr(import_module(f"cli.{module}"), attribute)
    app = declared
    if not isinstance(declared, typer.Typer):
        app = typer.Typer(rich_markup_mode=None, add_completion=False)
        add(app, "", declared)
    loaded: Any = typer.main.get_command(app)
    loaded.name = name
    return loaded


app = group(
    "brake-cal",
    "Calibrate and validate a brake-torque estimator from one ramped braking run.",
    "brake-cal demo",
    "brake-cal tables list",
    cls=Commands,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

_INTERRUPTED = 130  # exit code after Ctrl-C and SIGTERM, as typer gives it


def _print_version(is_wanted: bool) -> None:
    if is_wanted:
        typer.echo(PROGRAM)
        raise typer.Exit


_VERSION: Any = typer.Option(
    "--version", callback=_print_version, is_eager=True, help="Print the version."
)


@app.callback()
def options(version: Annotated[bool, _VERSION] = False) -> None:
    """Calibrate and validate a brake-torque estimator from one ramped braking run.

    Exit codes: 0 done or passed; 1 it ran, and the result fails its limits; 2 usage; 3 bad input; 4
    the store or a table is damaged or refused; 5 the answer could not be written; 6 the program
    itself failed.
    """


def main() -> None:
    """Run the command line. No other place turns errors into messages and exit codes."""
    for library in ("OPENBLAS", "OMP", "MKL"):
        # arrays are small here: threads of the linear algebra take more time than they save
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    # a command makes little garbage, and would spend a tenth of its time on looking for it
    gc.set_threshold(100_000)  # new objects until CPython looks, 700 by default
    begin_run()
    for number in STOP_SIGNALS:
        if signal.getsignal(number) != signal.SIG_IGN:  # a shell ignores them in the background
            signal.signal(number, _interrupt)
    code = delivered(_run)
    if code == _INTERRUPTED:
        # If an interrupt came while exec ran code, as a dataclass does, CPython ends by the signal
        # instead of the exit code, unless another exec succeeds
        exec("")
    sys.exit(code)


def _interrupt(number: int, frame: object) -> None:
    this_run().interrupted = True
    raise KeyboardInterrupt


def _run() -> int:
    """Run the command that was typed, print its error, and return the exit code."""
    try:
        code = app(prog_name="brake-cal", standalone_mode=False) or 0
    except NotWritten:
        raise
    except Exception as error:
        # an interrupt while a library is imported becomes an error of that import
        if not (this_run().interrupted or isinstance(error, typer.Abort)):
            return _report(error)
        code = _INTERRUPTED
    if code == _INTERRUPTED:
        say("stopped; nothing is half-written: the same command goes on, or begins again")
    return int(code)


def _report(error: Any) -> int:
    """Print an error, also as JSON if --json was typed and no document was printed."""
    failure = _failure(error)
    options = takewhile(lambda word: word != "--", sys.argv[1:])
    if "--json" in options and not this_run().documents:
        print_json({"schema": 1, "error": failure.to_dict()})
    if isinstance(error, _UsageError) and error.message.startswith("Usage:"):
        error.show()  # prints the help of a group, after which nothing was typed
    else:
        print_error(str(failure))
    return failure.exit_code


def _failure(error: Any) -> BrakeCalError:
    """Return an error as an error of the library. -v prints the traceback of any other error."""
    if isinstance(error, BrakeCalError):
        return error
    if isinstance(error, _UsageError):
        return _usage(error)
    if this_run().verbose:
        import traceback

        say("".join(traceback.format_exception(error)).rstrip())
    if isinstance(error, FileNotFoundError):
        try:
            os.getcwd()
        except FileNotFoundError:
            return UsageError("the working folder is gone", do="change to another")
    return program_failure(error)


def _usage(error: Any) -> UsageError:
    """Return an error of typer on the command line as an error of the library."""
    where, meaning = getattr(error, "param_hint", None), ""
    parameter: Any = getattr(error, "param", None)
    if parameter:
        meaning = parameter.help[:1].lower() + parameter.help[1:].removesuffix(".")
        name = parameter.metavar
        if parameter.param_type_name == "option":
            meaning = f"{parameter.metavar} ({meaning})"
            name = parameter.opts[0]
        where = where or name
    problem, expected = error.message.removesuffix("."), ""
    if hasattr(error, "param_type"):  # typer's MissingParameter
        problem, expected = "missing", meaning
    elif hasattr(error, "possibilities"):  # typer's NoSuchOption
        from calib.base.toml import did_you_mean

        hint = did_you_mean(error.option_name, error.possibilities or [])
        problem = f"unknown option {error.option_name}; {hint}".removesuffix("; ")
    for phrase, replacement in _PHRASES.items():
        problem = problem.replace(phrase, replacement)
    command = error.ctx.command_path if error.ctx else "brake-cal"
    problem = problem[:1].lower() + problem[1:]
    return UsageError(problem, where=where, expected=expected, do=f"see `{command} --help`")


_PHRASES = {
    "No such command": "unknown command",
    ". Did you mean": "; did you mean",
    "Got unexpected extra argument(s)": "unexpected argument",
    "requires an argument": "needs a value",
    "Input should be a valid integer, unable to parse string as an integer": "no whole number",
    "Input should be a valid number, unable to parse string as a number": "no number",
}
"""Phrases of typer, and what this program says instead."""


if __name__ == "__main__":
    main()

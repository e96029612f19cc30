"""The command line: its commands by subject, and the exit codes of their errors."""

import errno
import gc
import io
import os
import signal
import sys
from collections.abc import Callable
from importlib import import_module
from itertools import takewhile
from typing import Annotated, Any

import typer

from calib.base.errors import AnswerError, BrakeCalError, UsageError, program_failure
from calib.base.names import PROGRAM
from cli.command import Group, Row, add, group
from cli.console import STOP_SIGNALS, begin, complain, emit_json, say, this_run

_UsageError: Any = typer.BadParameter.__base__
"""What typer raises for a wrong command line; it exports only the one for a wrong value."""

_SUBJECTS = {
    "One car": {
        "plan:plan": "Say which runs make the torque better known, before they are driven",
        "log:check": "Say for what each log can be used, as far as can be told without a vehicle "
        "file",
        "fit:fit": "Make the look-up table of a car from ramped brakings",
        "validate:validate": "Run the estimator with a table on other logs, and judge what an "
        "ECU makes of it",
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
        "simulate:simulate": "Drive a model of a car by the pressure of a log",
        "reference:effects": "List the effects that a model can have",
    },
    "Files and settings": {
        "log:log": "Show, draw, cut or convert logs",
        "maps:map_": "Propose a channel map for a log of foreign names",
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
"""Commands by subject, "MODULE:FUNCTION" with the first sentence of its help."""

_PLACES = {
    Row(subject, place.partition(":")[2].rstrip("_"), summary): place
    for subject, summaries in _SUBJECTS.items()
    for place, summary in summaries.items()
}


class Commands(Group):
    """The commands of the program; each is imported when it is typed."""

    def rows(self) -> list[Row]:
        """Every command in the order of the help."""
        return [*_PLACES]

    def get_command(self, ctx: Any, name: str) -> Any:
        """The command of a name, None for an unknown one."""
        places = {row.name: place for row, place in _PLACES.items()}
        for known in {name} & {*places} or places:  # all, so that typer suggests one
            if known not in self.commands:
                self.commands[known] = _load(known, places[known])
        return super().get_command(ctx, name)


def _load(name: str, place: str) -> Any:
    """Import a command or a group from its place."""
    module, _, attribute = place.partition(":")
    command = subject = getattr(import_module(f"cli.{module}"), attribute)
    if not isinstance(command, typer.Typer):
        subject = typer.Typer(rich_markup_mode=None, add_completion=False)
        add(subject, "", command)
    loaded: Any = typer.main.get_command(subject)
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

_INTERRUPTED = 130
_GARBAGE = 100_000
"""New objects after which garbage is looked for; usually 700."""
"""Exit code after Ctrl-C and SIGTERM, as `typer` gives it."""


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
    the store or a table is damaged or refused; 5 the answer could not be written; 6 the program
    itself failed.
    """


def main() -> None:
    """Run the command line; the only place that turns errors into messages and exit codes."""
    for library in ("OPENBLAS", "OMP", "MKL"):
        # arrays are small here: threads of the linear algebra take more time than they save
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    # a tenth of a short command is the search for garbage that it does not make
    gc.set_threshold(_GARBAGE)
    begin()
    for number in STOP_SIGNALS:
        if signal.getsignal(number) != signal.SIG_IGN:  # as for a job of a shell's background
            signal.signal(number, _interrupt)
    code = _delivered(_run)
    if code == _INTERRUPTED:
        # CPython ends by the signal, not with the exit code, if an interrupt met code made from
        # text, such as that of a dataclass; running other such code takes that back
        exec("")
    sys.exit(code)


def _interrupt(number: int, frame: object) -> None:
    this_run().interrupted = True
    raise KeyboardInterrupt


def _run() -> int:
    """Exit code of the command line; an error is printed."""
    try:
        code = app(prog_name="brake-cal", standalone_mode=False) or 0
    except _NotWritten:
        raise
    except Exception as error:
        # an interrupt within the import of a library comes back as an error of that import
        if not (this_run().interrupted or isinstance(error, typer.Abort)):
            failure = _failure(error)
            _print_json(failure)
            if isinstance(error, _UsageError) and error.message.startswith("Usage:"):
                error.show()  # nothing was typed after a group: its help
            else:
                complain(str(failure))
            return failure.exit_code
        code = _INTERRUPTED
    if code == _INTERRUPTED:
        say("stopped; nothing is half-written: the same command goes on, or begins again")
    return int(code)


def _failure(error: Any) -> BrakeCalError:
    """An error as one of the library; for a fault of the program -v prints the traceback."""
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


def _print_json(failure: BrakeCalError) -> None:
    """Print an error as JSON if --json was given and no document was printed."""
    options = takewhile(lambda word: word != "--", sys.argv[1:])
    if "--json" in options and not this_run().documents:
        emit_json({"schema": 1, "error": failure.to_dict()})


def _usage(error: Any) -> UsageError:
    """A wrong command line as an error of the library."""
    command = error.ctx.command_path if error.ctx else "brake-cal"
    hint = getattr(error, "param_hint", None) or ""
    where = hint if isinstance(hint, str) else " ".join(hint)
    # without a hint the parser names the option itself, and those that may be meant
    message = (error.message if where else error.format_message()).removesuffix(".")
    message = message[:1].lower() + message[1:]
    return UsageError(message, where=where or None, do=f"see `{command} --help`")


# A full disk or a closed pipe must not lose output silently. Rich, typer and the interpreter each
# treat an OSError in their own way, so the streams raise `_NotWritten`, which none of them knows.

OUT, ERR = 1, 2
"""File descriptors of stdout and stderr."""


class _NotWritten(Exception):
    """A stream cannot be written; the cause is the OSError."""


class _Descriptor(io.FileIO):
    """A file descriptor whose failure is `_NotWritten`."""

    def write(self, data: Any) -> int:
        try:
            return super().write(data)
        except OSError as error:
            raise _NotWritten(error.strerror) from error


def _delivered(work: Callable[[], int]) -> int:
    """Exit code of ``work`` once its output is written, or that of `_undelivered`."""
    sys.stdout, sys.stderr = _guarded(sys.stdout, OUT), _guarded(sys.stderr, ERR)
    try:
        code = work()
        sys.stdout.flush()
        sys.stderr.flush()
    except _NotWritten as lost:
        return _undelivered(lost)
    return code


def _undelivered(lost: _NotWritten) -> int:
    """Exit code: 0 after a closed pipe, as of `head`; else that of `AnswerError`, and a message."""
    # what the interpreter flushes at its exit is discarded
    nowhere = os.open(os.devnull, os.O_WRONLY)
    os.dup2(nowhere, OUT)
    closed = sys.platform == "win32" and getattr(lost.__cause__, "errno", 0) == errno.EINVAL
    if closed or isinstance(lost.__cause__, BrokenPipeError):
        os.dup2(nowhere, ERR)
        return 0
    try:
        sys.stderr.write(f"error: {AnswerError(f'the answer could not be written ({lost})')}\n")
        sys.stderr.flush()
    except _NotWritten:
        os.dup2(nowhere, ERR)
    return AnswerError.exit_code


def _guarded(stream: Any, number: int) -> Any:
    """A ``stream`` of the shell on a `_Descriptor`; another one as it is.

    If the shell has closed it, writing to stdout fails, and messages are discarded.
    """
    if stream is None:
        nowhere = os.open(os.devnull, os.O_RDONLY if number == OUT else os.O_WRONLY)
        return io.TextIOWrapper(io.BufferedWriter(_Descriptor(nowhere, "w")), write_through=True)
    binary = getattr(stream, "buffer", None)
    raw = getattr(binary, "raw", binary)
    if not isinstance(raw, io.FileIO) or raw.fileno() != number:
        return stream
    stream.flush()
    guard = io.BufferedWriter(_Descriptor(number, "w", closefd=False))
    settings = {"errors": "backslashreplace", "line_buffering": stream.line_buffering}
    return io.TextIOWrapper(guard, stream.encoding, **settings)


if __name__ == "__main__":
    main()

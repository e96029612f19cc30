"""What the commands print: results on stdout, everything else on stderr, safe for a terminal.

rich is imported only where something is drawn, so that `--help` does not wait for it.
"""

import json
import os
import signal
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass, field
from pathlib import Path
from typing import IO, TYPE_CHECKING, Any

import typer

from calib.base.errors import printable

if TYPE_CHECKING:
    from rich.console import Console

    from calib.base.settings_file import Project
    from calib.show.facts import Facts

STOP_SIGNALS = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGBREAK") if hasattr(signal, name)
)
"""Signals that ask a run to stop; SIGBREAK is that of Ctrl-Break on Windows."""
_PIPED_WIDTH = 120  # characters in a line of tables, without a terminal and without COLUMNS


@dataclass
class _CommandRun:
    """Options and state of one run of the program."""

    quiet: bool = False  # the options -q, -v and --force
    verbose: bool = False
    force: bool = False
    documents: int = 0  # number of JSON documents that were printed
    inputs: dict[str, list[Path]] = field(default_factory=dict)  # files to read, by parameter
    project: "Project | None" = None  # settings of the project, once they are read
    uses_settings: bool = False  # whether a value of the settings was used
    interrupted: bool = False  # whether a signal asked the run to stop

    def file(self, name: str) -> Path | None:
        """Return the file that is read for a parameter; None without such a file."""
        return next(iter(self.inputs.get(name, ())), None)

    def files(self, *names: str) -> dict[str, Path]:
        """Return the files of parameters and the channel map, by the name that a page shows."""
        files = {name.replace("_", " "): self.file(name) for name in (*names, "channel_map")}
        return {name: file for name, file in files.items() if file is not None}


_RUN: ContextVar[_CommandRun] = ContextVar("run")


def begin_run() -> None:
    """Begin a run without options."""
    _RUN.set(_CommandRun())


def this_run() -> _CommandRun:
    """Return the current run, or a run without options."""
    return _RUN.get(_CommandRun())


def say(message: str) -> None:
    """Print a message on stderr, except with -q."""
    if not this_run().quiet:
        _console(sys.stderr).print(message, soft_wrap=True)


def print_error(message: str, word: str = "error:", style: str = "bold red") -> None:
    """Print ``error: message`` on stderr."""
    console = _console(sys.stderr)
    console.print(word, style=style, end=" ")
    console.print(message, soft_wrap=True)


def print_warnings(warnings: Iterable[object]) -> None:
    """Print each warning on stderr."""
    for warning in warnings:
        print_error(str(warning), "warning:", "bold yellow")


def usage_error(message: str, option: str | None = None) -> typer.BadParameter:
    """Return the error for a mistake on the command line, at an option or argument."""
    return typer.BadParameter(message, param_hint=option)


@contextmanager
def at_option(option: str | None, error: type[Exception]) -> Iterator[None]:
    """Turn an ``error`` of the library into a usage error at an option."""
    try:
        yield
    except error as cause:
        raise usage_error(str(cause), option) from None


class PageText(str):
    """Markdown of a page of the manual."""


def print_result(result: "Facts | str", stream: IO[str] | None = None) -> None:
    """Print a result on stdout, or on another stream; details of facts only with -v.

    A terminal shows a `PageText` in a pager.
    """
    from calib.show.terminal import Screen, drawn

    stream = stream or sys.stdout
    console, run = _console(stream), this_run()
    if isinstance(result, PageText) and stream.isatty():
        _show_page(result)
    elif isinstance(result, str):
        console.print(result, soft_wrap=True)
    else:
        width, wraps = console.options.max_width, not _is_piped(stream)
        for part in drawn(result, Screen(width, wraps, quiet=run.quiet, details=run.verbose)):
            console.print(part, soft_wrap=isinstance(part, str) or not wraps)  # str: to be copied


def _show_page(text: PageText) -> None:
    from rich.markdown import Markdown

    from calib.help.page import for_terminal

    os.environ.setdefault("LESS", "FRX")  # colours and links, and no pager for one screen
    console = _console(sys.stdout)
    with console.pager(styles=True, links=True):
        console.print(Markdown(for_terminal(text)))


def print_json(document: object) -> None:
    """Print ``document``, of the types that `plain` knows, as the JSON document of the run."""
    this_run().documents += 1
    print(json_text(document), end="", flush=True)  # noqa: T201


def json_text(document: object) -> str:
    """Return ``document`` as the text of a JSON file."""
    return json.dumps(plain(document), indent=2, allow_nan=False) + "\n"


def plain(value: object) -> Any:
    """Convert ``value`` to JSON types: dataclasses, mappings, sequences, paths, numpy, numbers.

    A number that is not finite becomes null. Raises TypeError for anything else.
    """
    from pydantic_core import to_jsonable_python

    return to_jsonable_python(value, inf_nan_mode="null", fallback=_unwrapped)


def _unwrapped(value: Any) -> Any:
    """Convert a mapping, or an array or scalar of numpy. Numpy is not imported for this."""
    if isinstance(value, Mapping):
        return dict(value)
    if hasattr(value, "tolist"):
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no place in a JSON document")


Step = Callable[..., None]
"""Report of progress: step() after each step, or step(stage, steps_done, in_all)."""


@contextmanager
def progress(task: str = "", total: int | None = None) -> Iterator[Step]:
    """Show the progress of a task, on a terminal as a bar. Yield the `Step` to call."""
    console = _console(sys.stderr)
    if this_run().quiet or not (sys.stderr.isatty() and console.is_interactive):
        if task:
            say(task)
        yield lambda *_stage: None
        return
    from rich.progress import Progress, TextColumn

    text = TextColumn("{task.description}", style="progress.description", markup=False)
    columns = (text, *Progress.get_default_columns()[1:])
    with Progress(*columns, console=console, transient=True) as bar:
        task_id = bar.add_task(printable(task), total=total)

        def step(stage: str = "", steps_done: int = -1, in_all: int = 0) -> None:
            if steps_done < 0:
                bar.advance(task_id)
                return
            bar.update(task_id, description=printable(stage), completed=steps_done, total=in_all)

        yield step


def _is_piped(stream: IO[str]) -> bool:
    return not stream.isatty() and "COLUMNS" not in os.environ


def _console(stream: IO[str]) -> "Console":
    """Return a console that escapes control characters."""
    from rich.console import Console
    from rich.text import Text

    class SafeConsole(Console):
        def render_str(self, text: str, **options: Any) -> Text:
            return super().render_str(printable(text, "\n\t"), **options)

    width = _PIPED_WIDTH if _is_piped(stream) else None
    # names and remarks of users may hold brackets and colons, so no string is taken as markup
    return SafeConsole(file=stream, width=width, highlight=False, markup=False, emoji=False)

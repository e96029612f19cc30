"""Output of the commands: results on stdout, everything else on stderr, safe for a terminal.

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
_PIPED_WIDTH = 120
"""Width of tables in characters without a terminal, if COLUMNS is not set."""


@dataclass
class _CommandRun:
    """Options and state of one run of the program.

    ``inputs`` are the files that were given, by parameter; ``documents`` counts JSON documents that
    were printed; ``project`` are the settings, once read.
    """

    quiet: bool = False
    verbose: bool = False
    force: bool = False
    documents: int = 0
    inputs: dict[str, list[Path]] = field(default_factory=dict)
    project: "Project | None" = None
    uses_settings: bool = False
    interrupted: bool = False

    def file(self, name: str) -> Path | None:
        """The file of an option, if one was given."""
        return next(iter(self.inputs.get(name, ())), None)


_RUN: ContextVar[_CommandRun] = ContextVar("run")


def begin() -> None:
    """Begin a run, with default options."""
    _RUN.set(_CommandRun())


def this_run() -> _CommandRun:
    """The current run, or a default one."""
    return _RUN.get(_CommandRun())


def say(message: str) -> None:
    """Print a message on stderr, but not with -q."""
    if not this_run().quiet:
        _console(sys.stderr).print(message, soft_wrap=True)


def complain(message: str, word: str = "error:", style: str = "bold red") -> None:
    """Print ``error: message`` on stderr."""
    to = _console(sys.stderr)
    to.print(word, style=style, end=" ")
    to.print(message, soft_wrap=True)


def warn(warnings: Iterable[object]) -> None:
    """Print each warning on stderr."""
    for warning in warnings:
        complain(str(warning), "warning:", "bold yellow")


def misuse(message: str, option: str | None = None) -> typer.BadParameter:
    """Return the error for a mistake in what was typed, at an option or an argument."""
    return typer.BadParameter(message, param_hint=option)


@contextmanager
def at_option(option: str | None, error: type[Exception]) -> Iterator[None]:
    """Turn an error of the library into a mistake of an option."""
    try:
        yield
    except error as cause:
        raise misuse(str(cause), option) from None


def emit(result: "Facts | str", to: IO[str] | None = None) -> None:
    """Print a result on stdout; details of facts only with -v."""
    from calib.show.terminal import drawn

    if isinstance(result, PageText) and sys.stdout.isatty():
        _show_page(result)
        return
    stream, run = to or sys.stdout, this_run()
    console, piped = _console(stream), _piped(stream)
    shown = {"quiet": run.quiet, "details": run.verbose}
    for part in [result] if isinstance(result, str) else drawn(result, **shown):
        console.print(part, soft_wrap=piped or isinstance(part, str))


class PageText(str):
    """Markdown of a page: a terminal shows it in a pager, at its width."""

    __slots__ = ()


def _show_page(text: PageText) -> None:
    from rich.markdown import Markdown

    from calib.help.page import for_terminal

    os.environ.setdefault("LESS", "FRX")  # colours and links, and no pager for one screen
    console = _console(sys.stdout)
    with console.pager(styles=True, links=True):
        console.print(Markdown(for_terminal(text)))


def emit_line(text: str) -> None:
    """Print a line on stdout at once."""
    print(printable(text), flush=True)  # noqa: T201


def emit_json(document: object) -> None:
    """Print ``document`` as the only JSON document on stdout; its types are those of `plain`."""
    this_run().documents += 1
    print(json_text(document), end="", flush=True)  # noqa: T201


def json_text(document: object) -> str:
    """``document`` as the text of a JSON file."""
    return json.dumps(plain(document), indent=2, allow_nan=False) + "\n"


def plain(value: object) -> Any:
    """Convert ``value`` to JSON types: dataclasses, mappings, sequences, paths, numpy, numbers.

    A number that is not finite becomes null. Raises TypeError for anything else.
    """
    from pydantic_core import to_jsonable_python

    return to_jsonable_python(value, inf_nan_mode="null", fallback=_unwrapped)


def _unwrapped(value: Any) -> Any:
    if isinstance(value, Mapping):
        return dict(value)
    if hasattr(value, "tolist"):  # numpy scalars and arrays, without importing numpy
        return value.tolist()
    raise TypeError(f"{type(value).__name__} has no place in a JSON document")


Step = Callable[..., None]
"""Called after each step without arguments, or as step(stage, steps_done, steps_in_all)."""


@contextmanager
def progress(task: str = "", total: int | None = None) -> Iterator[Step]:
    """Show the progress of a task, as a bar on a terminal; yields a `Step`."""
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

        def step(stage: str = "", completed: int = -1, count: int = 0) -> None:
            if completed < 0:
                bar.advance(task_id)
            else:
                bar.update(task_id, description=printable(stage), completed=completed, total=count)

        yield step


def _piped(stream: IO[str]) -> bool:
    return not stream.isatty() and "COLUMNS" not in os.environ


def _console(stream: IO[str]) -> "Console":
    """A console that escapes control characters, also in the cells of a grid."""
    from rich.console import Console
    from rich.text import Text

    class SafeConsole(Console):
        def render_str(self, text: str, **options: Any) -> Text:
            return super().render_str(printable(text, "\n\t"), **options)

    width = _PIPED_WIDTH if _piped(stream) else None
    # Names and remarks of users may hold brackets and colons, so no string is taken as markup.
    return SafeConsole(file=stream, width=width, highlight=False, markup=False, emoji=False)

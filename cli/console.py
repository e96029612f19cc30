"""Output of the commands: results on stdout, everything else on stderr.

rich is imported only where something is drawn, so that `--help` does not wait for it. Whatever is
printed for people is made safe for a terminal on its way, see `cli.terminal`.
"""

import json
import math
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import fields, is_dataclass
from pathlib import PurePath
from typing import IO, TYPE_CHECKING, Any

from calib.base.printable import printable
from cli.loudness import this_run

if TYPE_CHECKING:
    from rich.console import Console, RenderableType
    from rich.progress import Progress

    from calib.show.facts import Facts

PIPED_WIDTH = 120
"""Columns of output that does not go to a terminal, if COLUMNS is not set."""


def console() -> "Console":
    """Console on stderr; without colour where NO_COLOR is set or stderr is no terminal."""
    return _console(sys.stderr)


def say(message: str) -> None:
    """Print on stderr what is being done, but not with -q; printed without markup."""
    if not this_run().quiet:
        console().print(message, soft_wrap=True)


def detail(message: str) -> None:
    """Print on stderr what only -v asks for."""
    if this_run().verbose:
        say(message)


def complain(message: str) -> None:
    """Print ``error: message`` on stderr."""
    to = console()
    to.print("error:", style="bold red", end=" ")
    to.print(message, soft_wrap=True)


def warn(warnings: Iterable[object]) -> None:
    """Print each warning on stderr."""
    to = console()
    for warning in warnings:
        to.print("warning:", style="bold yellow", end=" ")
        to.print(str(warning), soft_wrap=True)


def emit(renderable: "RenderableType", whole: bool = False) -> None:
    """Print a result on stdout; a string without markup, anything else drawn by rich.

    With ``whole`` a drawn line that is wider than the terminal is not cut.
    """
    text = isinstance(renderable, str)
    _console(sys.stdout).print(renderable, soft_wrap=text, crop=not (text or whole))


def emit_facts(facts: "Facts") -> None:
    """Print a result on stdout; its verdict is the last line."""
    from calib.show.terminal import drawn

    for one in drawn(facts):
        emit(one)


def emit_json(document: object) -> None:
    """Print ``document`` as the only JSON document on stdout; its types are those of `plain`."""
    this_run().documents += 1
    print(json_text(document), end="", flush=True)  # noqa: T201


def emit_line(text: str) -> None:
    """Print a line on stdout at once, without markup."""
    print(printable(text), flush=True)  # noqa: T201


def json_text(document: object) -> str:
    """``document`` as the text of a JSON file."""
    return json.dumps(plain(document), indent=2, allow_nan=False) + "\n"


def json_line(document: object) -> str:
    """``document`` as one line of JSON."""
    return json.dumps(plain(document), allow_nan=False)


def plain(value: object) -> Any:
    """Convert ``value`` to JSON types: dataclasses, mappings, sequences, paths, numpy, numbers.

    A number that is not finite becomes null. Raises TypeError for anything else.
    """
    if value is None or isinstance(value, bool | str | int):
        return value
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, PurePath):
        return str(value)
    if is_dataclass(value) and not isinstance(value, type):
        return {f.name: plain(getattr(value, f.name)) for f in fields(value)}
    if isinstance(value, Mapping):
        return {str(key): plain(part) for key, part in value.items()}
    if isinstance(value, list | tuple):
        return [plain(part) for part in value]
    if hasattr(value, "tolist"):  # numpy scalars and arrays, without importing numpy
        return plain(value.tolist())
    raise TypeError(f"{type(value).__name__} has no place in a JSON document")


@contextmanager
def progress(task: str, total: int) -> Iterator[Callable[[], None]]:
    """Show a bar for ``total`` steps on stderr; yields the function to call after each step.

    Without a terminal it prints the task once and draws nothing.
    """
    if not is_watched():
        say(task)
        yield lambda: None
        return
    with progress_bar(task, total) as bar:
        (step,) = bar.task_ids
        yield lambda: bar.advance(step)


@contextmanager
def stages() -> Iterator[Callable[[str, int, int], None]]:
    """Show on stderr the stage of a long work, with a bar of its steps.

    Yields the function to call at each step: the stage, its steps that are done, their number.
    Without a terminal nothing is shown.
    """
    if not is_watched():
        yield lambda _stage, _done, _total: None
        return
    with progress_bar("", None, time_left=False) as bar:
        (task,) = bar.task_ids
        yield lambda stage, done, total: bar.update(
            task, description=printable(stage), completed=done, total=total
        )


def is_watched() -> bool:
    """Whether stderr is a terminal on which a bar can be drawn; never with -q."""
    return not this_run().quiet and sys.stderr.isatty() and console().is_interactive


def progress_bar(task: str, total: int | None, time_left: bool = True) -> "Progress":
    """Return a bar of one task on stderr, removed at the end; ``task`` is printed without markup.

    ``time_left`` shows the remaining time as rich estimates it.
    """
    from rich.progress import Progress, TextColumn

    text = TextColumn("{task.description}", style="progress.description", markup=False)
    _, drawn, percent, left = Progress.get_default_columns()
    columns = (text, drawn, percent, *[left] * time_left)
    bar = Progress(*columns, console=console(), transient=True)
    bar.add_task(printable(task), total=total)
    return bar


def _console(stream: IO[str]) -> "Console":
    from cli.terminal import SafeConsole

    width = None if stream.isatty() or "COLUMNS" in os.environ else PIPED_WIDTH
    # Names and remarks of users may hold brackets and colons, so no string is taken as markup.
    return SafeConsole(file=stream, width=width, highlight=False, markup=False, emoji=False)

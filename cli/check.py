"""`brake-cal check`: what a log contains, and for what it can be used."""

from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from cli.failure import document_of
from cli.grid import facts_grid
from cli.inputs import channel_map_of
from cli.logs import named, open_table, read, tell
from cli.loudness import this_run
from cli.options import Json, Map, example

if TYPE_CHECKING:
    from rich.panel import Panel

    from calib.base.errors import InputError
    from calib.logs.channel_map import ChannelMap
    from calib.run.check import Findings

EPILOG = example("brake-cal check sample_logs/sedan/*.csv")

USELESS, UNREADABLE = 1, 3

Logs = Annotated[list[Path], typer.Argument(metavar="LOG...", help="logs to check")]


def check(logs: Logs, channel_map: Map = None, json: Json = False) -> None:
    """Say for what each log can be used.

    One line for each; -v shows what the log contains as well. Exit code 1 if a log is usable for
    nothing, 3 if one cannot be read.
    """
    from calib.run.check import to_dict
    from calib.run.check_words import line
    from cli.console import complain, emit, emit_json, say

    found, errors = _look(logs, channel_map_of(channel_map))
    if json:
        failed = [{"source": path, "error": str(error)} for path, error in errors]
        document = {"schema": 1, "logs": [to_dict(f) for f in found], "unreadable": failed}
        first = document_of(errors[0][1]) if errors else {}
        emit_json({**first, **document})
    else:
        for findings in found:
            emit(line(findings))
            if this_run().verbose:
                emit(_panel(findings))
        for _, error in errors:
            complain(str(error))
        if found and not this_run().verbose:
            say("-v shows what is in each log")
    if errors:
        raise typer.Exit(UNREADABLE)
    if not all(findings.usable for findings in found):
        raise typer.Exit(USELESS)


def _look(
    logs: list[Path], mapping: "ChannelMap | None"
) -> "tuple[list[Findings], list[tuple[Path, InputError]]]":
    """Check every log; one that cannot be read does not stop the check of the others."""
    from calib.base.errors import InputError
    from calib.logs.formats import RECORDINGS, ending_of
    from calib.logs.read import read_opened
    from calib.run.check import check as look_at
    from calib.run.copies import computed_channels

    found, errors = [], []
    for path, name in _watched(logs, named(logs)):
        try:
            # a bus has thousands of signals: no search for copies of a pressure among them
            if ending_of(name) in RECORDINGS:
                found.append(look_at(read(path, mapping, require=())))
            else:
                opened = open_table(path, mapping)
                log = read_opened(opened, name, mapping, require=())
                tell(log)
                found.append(look_at(log, computed_channels(log, opened.source)))
        except InputError as error:
            errors.append((path, error))
    return found, errors


def _watched(logs: list[Path], names: list[Path]) -> "Iterator[tuple[Path, Path]]":
    """Each log with the name that results have for it; a bar on a terminal meanwhile."""
    from cli.console import stages

    with stages() as tell:
        for i, (path, name) in enumerate(zip(logs, names, strict=True)):
            tell(f"reading {name.name}", i, len(logs))
            yield path, name


def _panel(findings: "Findings") -> "Panel":
    from rich.panel import Panel

    from calib.run.check import facts
    from cli.terminal import safe_text

    grid = facts_grid()
    for label, text in facts(findings):
        grid.add_row(label, text)
    for text in findings.notes:
        grid.add_row("read", text)
    for warning in findings.warnings:
        grid.add_row(safe_text("warning", "yellow"), warning.text)
    for verdict in findings.verdicts:
        word, colour = ("usable", "green") if verdict.usable else ("not usable", "red")
        lines = [word, *(f"- {reason}" for reason in verdict.reasons)]
        grid.add_row(verdict.purpose, safe_text("\n".join(lines), colour))
    return Panel(grid, title=safe_text(findings.source), title_align="left")

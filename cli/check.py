"""`brake-cal check`: what is in a log, is it usable, and for what."""

from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from cli.options import Json, Map, example

if TYPE_CHECKING:
    from rich.panel import Panel

    from calib.checks.check import Findings
    from calib.errors import InputError

EPILOG = example("brake-cal check sample_logs/sedan/*.csv")

USELESS, UNREADABLE = 1, 3

Logs = Annotated[list[Path], typer.Argument(metavar="LOG...", help="logs to look at")]


def check(logs: Logs, channel_map: Map = None, json: Json = False) -> None:
    """Say what is in each log, whether it is usable, and for what.

    Exit code 1 if a log is usable for nothing, 3 if one cannot be read.
    """
    from calib.checks.check import to_dict
    from calib.logs.channel_map_file import read_channel_map
    from cli.console import complain, emit, emit_json

    mapping = read_channel_map(channel_map) if channel_map else None
    found, errors = _look(logs, mapping)
    if json:
        failed = [{"source": path, "error": str(error)} for path, error in errors]
        emit_json({"schema": 1, "logs": [to_dict(f) for f in found], "unreadable": failed})
    else:
        for findings in found:
            emit(_panel(findings))
        for _, error in errors:
            complain(str(error))
    if errors:
        raise typer.Exit(UNREADABLE)
    if not all(findings.usable for findings in found):
        raise typer.Exit(USELESS)


def _look(logs: list[Path], mapping: Any) -> "tuple[list[Findings], list[tuple[Path, InputError]]]":
    """Check every log; one that cannot be read does not keep the others from being seen."""
    from calib.checks.check import check as look_at
    from calib.checks.computed_channels import computed_channels
    from calib.errors import InputError
    from calib.logs.read import open_log, read_log, read_opened
    from calib.logs.recordings import RECORDINGS
    from calib.logs.tables import ending_of

    found, errors = [], []
    for path in logs:
        try:
            # a bus carries thousands of signals: there nobody looks for copies of a pressure
            if ending_of(path) in RECORDINGS:
                found.append(look_at(read_log(path, mapping, require=())))
            else:
                opened = open_log(path, mapping)
                log = read_opened(opened, path, mapping, require=())
                found.append(look_at(log, computed_channels(log, opened.source)))
        except InputError as error:
            errors.append((path, error))
    return found, errors


def _panel(findings: "Findings") -> "Panel":
    from rich.panel import Panel
    from rich.table import Table
    from rich.text import Text

    from calib.checks.check import facts

    grid = Table(box=None, show_header=False, pad_edge=False)
    grid.add_column(style="bold", no_wrap=True)
    grid.add_column(overflow="fold")
    for label, text in facts(findings):
        grid.add_row(label, Text(text))
    for text in findings.notes:
        grid.add_row("read", Text(text))
    for text in findings.warnings:
        grid.add_row(Text("warning", style="yellow"), Text(text))
    for verdict in findings.verdicts:
        word, colour = ("usable", "green") if verdict.usable else ("not usable", "red")
        lines = [word, *(f"- {reason}" for reason in verdict.reasons)]
        grid.add_row(verdict.purpose, Text("\n".join(lines), style=colour))
    return Panel(grid, title=Text(findings.source), title_align="left")

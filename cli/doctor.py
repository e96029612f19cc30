"""`brake-cal doctor`: whether the program can work on this machine."""

import shutil
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from calib.base.program import PROGRAM, VERSION
from cli.console import emit, emit_json
from cli.grid import grid
from cli.options import Json, example
from cli.project import STORE, find_project

if TYPE_CHECKING:
    from calib.help.doctor import Finding

EPILOG = example("brake-cal doctor", "brake-cal doctor --json")
WRONG = 1


def doctor(
    store: Annotated[
        Path | None,
        typer.Option("--store", metavar="DIR", help="Directory of the tables; else as usual."),
    ] = None,
    json: Json = False,
) -> None:
    """Say whether the program can work on this machine.

    Looks at the packages against the lowest versions that hold, the extras and what they give, the
    font of the pictures, cores, memory, the store, the settings and the terminal. It writes nothing
    and uses no network. Exit code 0 if it can work, 1 if something that it needs is wrong.
    """
    from calib.help import doctor as library

    settings, usual = _settings()
    found = [*library.examine(store or usual or STORE), settings, *_terminal()]
    wrong = [one for one in found if one.state == library.WRONG]
    if json:
        verdict = library.WRONG if wrong else library.FINE
        emit_json({"schema": 1, "version": VERSION, "verdict": verdict, "findings": found})
    else:
        _report(found, wrong)
    if wrong:
        raise typer.Exit(WRONG)


def _report(found: "list[Finding]", wrong: "list[Finding]") -> None:
    names = ", ".join(one.name for one in wrong)
    can = f"cannot work here: {names}" if wrong else "can work here"
    emit(f"{PROGRAM} {can}")
    emit("")
    table = grid("", "state", "found", fold=True)
    for one in found:
        table.add_row(one.name, one.state, "; ".join(filter(None, (one.what, one.do))))
    emit(table)


def _settings() -> "tuple[Finding, Path | None]":
    """The settings file, and the store that it names."""
    from calib.base.errors import SettingsError
    from calib.help.doctor import FINE, WRONG, Finding

    try:
        project = find_project()
    except SettingsError as error:
        return Finding("settings", WRONG, str(error), "mend the file"), None
    what = str(project.file) if project.file else "no brake-cal.toml: the usual values"
    return Finding("settings", FINE, what), project.settings.store


def _terminal() -> "Iterator[Finding]":
    from calib.help.doctor import FINE, NOTE, Finding

    width, kind = shutil.get_terminal_size().columns, "terminal" if sys.stdout.isatty() else "pipe"
    encoding = sys.stdout.encoding or "unknown"
    plain = encoding.lower().replace("-", "") == "utf8"
    do = "" if plain else "set PYTHONUTF8=1 for names with other letters"
    yield Finding("output", FINE if plain else NOTE, f"{kind}, {width} columns, {encoding}", do)

"""`brake-cal settings`: the settings that count here, and where each comes from."""

from dataclasses import dataclass, fields
from typing import TYPE_CHECKING

from cli.console import emit, emit_json, say
from cli.grid import grid
from cli.options import Json, example
from cli.project import STORE, find_project

if TYPE_CHECKING:
    from cli.project import Project

EPILOG = example("brake-cal settings", "brake-cal settings --json")
KEYS = {
    "station": "station.name",
    "golden": "station.golden",
    "export": "station.export",
    "public_key": "keys.public",
}
"""Where a setting has another name in the file."""


@dataclass(frozen=True)
class ShownSetting:
    """One setting: its key in the file, its value, and who says so."""

    key: str
    value: object
    source: str


def settings(json: Json = False) -> None:
    """Show each setting, its value and where it comes from.

    The file is brake-cal.toml in this folder or the nearest one above that has it; the variable
    BRAKE_CAL_SETTINGS names another one, or none if it is empty. Its paths lead from its folder. An
    option on the command line wins over it. Which command takes what:

    \b
    store    every command with --store
    map      every command with --map but `map suggest`
    vehicle  fit, station, simulate, diagnose, repeatability, batch and watch fit;
             not validate and plot: there the vehicle is that of the table
    limits   station, validate, batch and watch validate
    station  station: name is --station, golden is --golden, export is --export
    keys.public, require_signed, by   who signs and changes the state of tables
    """  # noqa: D301
    found = find_project()
    rows = _rows(found)
    if json:
        emit_json(
            {
                "schema": 1,
                "file": found.file,
                "searched": found.searched,
                "settings": {r.key: {"value": r.value, "source": r.source} for r in rows},
            }
        )
        return
    if found.file is None:
        say(_nowhere(found))
    table = grid("setting", "value", "from", fold=True)
    for row in rows:
        table.add_row(row.key, _words(row.value), row.source)
    emit(table)


def _rows(found: "Project") -> list[ShownSetting]:
    from calib.store.state import user

    told, source = found.settings, f"file:{found.file}"
    rows = []
    for field in fields(told):
        key = KEYS.get(field.name, field.name)
        value = getattr(told, field.name)
        if value is not None:
            rows.append(ShownSetting(key, value, source))
        elif field.name == "by":
            rows.append(ShownSetting(key, user(), "environment"))
        else:
            built_in = {"store": STORE, "require_signed": False}.get(field.name)
            rows.append(ShownSetting(key, built_in, "built-in"))
    return rows


def _words(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, tuple):
        return ", ".join(value) or "none"
    return "none" if value is None else str(value)


def _nowhere(found: "Project") -> str:
    from calib.base.settings import NAME, VARIABLE

    if found.named:
        return f"no settings file: {VARIABLE} is empty"
    return f"no {NAME} in {', '.join(map(str, found.searched))}"

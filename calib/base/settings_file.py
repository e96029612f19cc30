"""`brake-cal.toml`, the settings of a project, in the working folder or the nearest above it."""

import os
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from pydantic import BeforeValidator

from calib.base.errors import SettingsError
from calib.base.names import PUBLIC_KEY, SETTINGS_FILE, SETTINGS_VARIABLE
from calib.base.record import FileSchema, Section, read_toml
from calib.base.record_errors import wrong
from calib.base.toml import shown


def _text(written: object) -> object:
    if isinstance(written, str) and not (written.strip() and written.isprintable()):
        raise wrong(f"{shown(written)} says nothing that can be printed", "text of one line")
    return written


Text = Annotated[str, BeforeValidator(_text)]


class _StationSection(Section):
    """Settings of `brake-cal station`."""

    name: Text | None = None
    golden: Text | None = None
    export: list[Text] | None = None


class _KeysSection(Section):
    """Keys that signatures are checked with."""

    public: Text | None = None


class SettingsFile(FileSchema):
    """Values for options that are not given on the command line. Paths start in its folder."""

    store: Text | None = None
    vehicle: Text | None = None
    map: Text | None = None
    limits: Text | None = None
    station: _StationSection = _StationSection()
    keys: _KeysSection = _KeysSection()
    require_signed: bool | None = None
    by: Text | None = None


def read_settings(path: Path | None) -> dict[str, Any]:
    """Values of a settings file by key, such as ``station.name``; None for those it does not have.

    Paths are relative to the working folder. Raises one SettingsError with all mistakes.
    """
    file = read_toml(path, SettingsFile, SettingsError) if path else SettingsFile(schema=1)
    folder = path.absolute().parent if path else Path()
    with suppress(ValueError, OSError):  # another drive of Windows; no working folder any more
        folder = Path(os.path.relpath(folder))

    def place(written: str | None) -> Path | None:
        return None if written is None else folder / written

    golden, public = file.station.golden, file.keys.public
    return {
        **{key: place(getattr(file, key)) for key in ("store", "vehicle", "map", "limits")},
        "station.name": file.station.name,
        # With a folder it is a path, else the name of a table.
        "station.golden": str(place(golden)) if golden and Path(golden).name != golden else golden,
        "station.export": file.station.export,
        # The text of a key, else the path of its file.
        "keys.public": public if public and PUBLIC_KEY.fullmatch(public) else place(public),
        "require_signed": file.require_signed,
        "by": file.by,
    }


class Project(NamedTuple):
    """Settings as by `read_settings`, their ``file`` or None, and the ``folders`` searched."""

    settings: dict[str, Any]
    file: Path | None
    folders: tuple[Path, ...]


def find_project() -> Project:
    """Find and read the settings file. Raises SettingsError if it is not valid."""
    named = os.environ.get(SETTINGS_VARIABLE)
    folders: tuple[Path, ...] = ()
    file = Path(named) if named else None  # an empty variable: no settings file
    if named is None:
        with suppress(FileNotFoundError):  # somebody has deleted the working folder
            folders = (Path.cwd(), *Path.cwd().parents)
        candidates = (folder / SETTINGS_FILE for folder in folders)
        files = (Path(os.path.relpath(path)) for path in candidates if os.path.isfile(path))
        file = next(files, None)
    return Project(read_settings(file), file, folders)

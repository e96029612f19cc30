"""Settings of a project: `brake-cal.toml` in the working folder or the nearest folder above it."""

import os
from contextlib import suppress
from pathlib import Path
from typing import Annotated, Any, NamedTuple

from pydantic import BeforeValidator

from calib.base.errors import SettingsError
from calib.base.names import PUBLIC_KEY, SETTINGS_FILE, SETTINGS_VARIABLE
from calib.base.record import FileSchema, Section, read_toml
from calib.base.record_errors import wrong
from calib.base.toml import shortened


def _require_printable(written: object) -> object:
    if isinstance(written, str) and not (written.strip() and written.isprintable()):
        raise wrong(f"{shortened(written)} says nothing that can be printed", "text of one line")
    return written


_Text = Annotated[str, BeforeValidator(_require_printable)]


class _StationSection(Section):
    """Settings of `brake-cal station`."""

    name: _Text | None = None
    golden: _Text | None = None
    export: list[_Text] | None = None


class _KeysSection(Section):
    """Keys with which signatures are checked."""

    public: _Text | None = None


class SettingsFile(FileSchema):
    """Values for options that are not on the command line. Paths are relative to its folder."""

    store: _Text | None = None
    vehicle: _Text | None = None
    map: _Text | None = None
    limits: _Text | None = None
    station: _StationSection = _StationSection()
    keys: _KeysSection = _KeysSection()
    require_signed: bool | None = None
    by: _Text | None = None


def read_settings(path: Path | None) -> dict[str, Any]:
    """Return the values of a settings file by key, such as ``station.name``; None if not set.

    Paths are relative to the working folder. Raises one SettingsError with all mistakes.
    """
    file = read_toml(path, SettingsFile, SettingsError) if path else SettingsFile(schema=1)
    folder = path.absolute().parent if path else Path()
    # fails between drives of Windows, and where somebody has deleted the working folder
    with suppress(ValueError, OSError):
        folder = Path(os.path.relpath(folder))

    def path_of(written: str | None) -> Path | None:
        return None if written is None else folder / written

    golden, public = file.station.golden, file.keys.public
    if golden is not None and Path(golden).name != golden:  # a path, not the name of a table
        golden = str(path_of(golden))
    is_key = public is not None and PUBLIC_KEY.fullmatch(public)  # else the path of its file
    return {
        **{key: path_of(getattr(file, key)) for key in ("store", "vehicle", "map", "limits")},
        "station.name": file.station.name,
        "station.golden": golden,
        "station.export": file.station.export,
        "keys.public": public if is_key else path_of(public),
        "require_signed": file.require_signed,
        "by": file.by,
    }


class Project(NamedTuple):
    """The settings that hold in the working folder, and where they come from."""

    settings: dict[str, Any]  # as `read_settings` returns them
    file: Path | None
    folders: tuple[Path, ...]  # in which the file was searched, the nearest first


def find_project() -> Project:
    """Find and read the settings file. Raises SettingsError if it is not valid.

    The variable `BRAKE_CAL_SETTINGS` names the file; if the variable is empty, there is none.
    """
    variable = os.environ.get(SETTINGS_VARIABLE)
    if variable is not None:
        file = Path(variable) if variable else None
        return Project(read_settings(file), file, ())
    folders: tuple[Path, ...] = ()
    with suppress(FileNotFoundError):  # somebody has deleted the working folder
        folders = (Path.cwd(), *Path.cwd().parents)
    candidates = (folder / SETTINGS_FILE for folder in folders)
    files = (Path(os.path.relpath(path)) for path in candidates if os.path.isfile(path))
    file = next(files, None)
    return Project(read_settings(file), file, folders)

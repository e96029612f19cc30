"""Values of options that were not given: those of the project's settings file.

An option asks for its value through `from_settings`, so no command looks for a settings file. The
file is read once in a run of the program, and only if an option asks.
"""

import os
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import typer

from cli.console import say

if TYPE_CHECKING:
    from calib.base.settings import Settings

KEY = "cli.project"

STORE = Path("tables")
"""The store where neither the command line nor the settings file names one."""


@dataclass(frozen=True)
class _Project:
    """The settings that count here; ``file`` is None where none was found.

    ``named`` tells whether the environment names the file. ``searched``: the folders that were
    looked into.
    """

    settings: "Settings"
    file: Path | None
    named: bool
    searched: tuple[Path, ...]


def find_project() -> _Project:
    """Find and read the settings file. Raises SettingsError if it is not valid."""
    from calib.base.settings import VARIABLE, Settings, find_settings, folders_to_search
    from calib.base.settings_file import read_settings

    named, here = os.environ.get(VARIABLE), None
    if named is not None:
        file = Path(named) if named else None
    else:
        with suppress(FileNotFoundError):  # somebody has deleted the working folder
            here = Path.cwd()
        found = find_settings(here) if here else None
        file = Path(os.path.relpath(found)) if found else None
    settings = read_settings(file) if file else Settings()
    return _Project(
        settings, file, named is not None, tuple(folders_to_search(here)) if here else ()
    )


def from_settings(
    name: str, needed: str = "", when: Callable[[typer.Context], bool] = lambda context: True
) -> Callable[..., Any]:
    """Callback of an option that takes its value from a setting where it is not given.

    Parameters
    ----------
    name : field of `calib.base.settings.Settings`.
    needed : what is missing where neither gives a value, a usage error; "" if it may be missing.
    when : whether the setting applies, from the arguments of the command that were given.
    """

    def value_of(context: typer.Context, option: typer.CallbackParam, value: Any) -> Any:
        source = context.get_parameter_source(str(option.name))
        if context.resilient_parsing or source is None or source.name != "DEFAULT":
            return value
        if when(context):
            if KEY not in context.meta:  # which all contexts of a run share
                context.meta[KEY] = find_project()
            setting = getattr(context.meta[KEY].settings, name)
            if setting is not None:
                if not context.meta.get("cli.project.told"):
                    context.meta["cli.project.told"] = True
                    say(f"settings of {context.meta[KEY].file}")
                return [*setting] if isinstance(setting, tuple) else setting
        if needed and value is None:
            raise typer.BadParameter(needed, context, param_hint=option.opts[0])
        return value

    return value_of

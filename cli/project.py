"""Values of options that were not given: those of the project's settings file.

An option asks for its value through `from_settings`, so no command looks for a settings file. The
file is read once in a run of the program, and only if an option asks.
"""

from collections.abc import Callable
from typing import Any

import typer

from cli.console import say

KEY = "cli.project"


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
                from calib.base.settings_file import find_project

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

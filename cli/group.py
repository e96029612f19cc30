"""A group of commands: its help by subject, and what there was once."""

from collections.abc import Iterator
from typing import Any

from typer.core import TyperGroup

HEADINGS = (
    *("One car", "Tables", "The line", "Where model and car disagree", "Files and settings"),
    *("Help", "Look", "Decide", "Hand out", "Commands"),
)
"""Headings of the help, in their order."""

PAGES = {
    "validation": ("accuracy", "warnings"),
    "logs": ("bad_input", "formats", "log_format"),
    "vehicle_file": ("own_effect",),
    "method": ("glossary",),
    "tables": ("a2l", "signatures", "store"),
    "line": ("fleet", "qualify", "settings"),
    "reference": ("commands", "json", "python"),
}
"""Pages of the manual, each with the former ones that are a part of it now."""

GONE = {
    "tables derive": "fit LOG...",
    "tables import": "tables compare FILE",
    "tables find": "tables list --serial S, or --vin V",
    "tables key": "tables sign --key SECRET --new-key PUBLIC",
    "map suggest": "map LOG",
    "limits init": "limits",
    "fleet report": "fleet RESULTS.parquet",
    "fleet index": "fleet DIR",
    "watch --index": "fleet DIR",
    "log view": "log LOG",
    "log cut": "log LOG --out FILE --from TIME --until TIME",
    "log convert": "log LOG --out FILE",
    "log --to": "log LOG --out FILE, once for each log, with --until TIME to cut",
    "log --keep-names": "log LOG --out FILE without --map",
    "simulate --deceleration": "simulate --pressure P; 'vehicle show' has the pressure per g",
    "vehicle init --from": "vehicle init FILE",
    "repeatability --folders": "repeatability --plan PLAN.csv",
    "repeatability --road": "repeatability LOG... --plan PLAN.csv",
    "manual --html": "manual PAGE",
    **{f"manual {old}": f"manual {new}" for new in PAGES for old in PAGES[new]},
}
"""Commands, arguments and options that there were once, and what to use instead."""


class Group(TyperGroup):
    """Commands under their headings; a summary is never cut."""

    def list_commands(self, ctx: Any) -> list[str]:
        """Names of the commands in the order of the help."""
        return [name for _, names in self._subjects() for name in names]

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write each subject with its commands."""
        width = max(map(len, self.commands), default=0)
        for heading, names in self._subjects():
            rows = [(name.ljust(width), self.commands[name].short_help) for name in names]
            with formatter.section(heading):
                formatter.write_dl(rows)

    def _subjects(self) -> Iterator[tuple[str, list[str]]]:
        for heading in HEADINGS:
            names = [n for n, c in self.commands.items() if _heading(c) == heading]
            if names:
                yield heading, names

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command that was typed; one that stands in a group below is named with its group."""
        typed = args[0]
        path = " ".join([*ctx.command_path.split()[1:], typed])
        after = " ".join(args[1:]).replace("=", " ").split()
        options = [word for word in after if word.startswith("-")]
        for words in (path, *(f"{path} {word}" for word in (*after[:1], *options))):
            if instead := GONE.get(words):
                ctx.fail(f"{words!r} is gone. Use 'brake-cal {instead}'.")
        if typed not in self.commands:
            groups = {k: x for k, x in self.commands.items() if isinstance(x, Group)}
            within = [f"'{k} {typed}'" for k, group in groups.items() if typed in group.commands]
            if within:
                ctx.fail(f"No such command {typed!r}. Did you mean {' or '.join(within)}?")
        return super().resolve_command(ctx, args)


def _heading(command: Any) -> str:
    panel = command.rich_help_panel
    return panel if isinstance(panel, str) else "Commands"


def first_sentence(text: str) -> str:
    r"""The first sentence of a help text, in one line and without its full stop.

    >>> first_sentence("Fit the table of a car.\n\nMore on it.")
    'Fit the table of a car'
    """
    paragraph = " ".join(text.strip().split("\n\n")[0].split())
    return paragraph.split(". ")[0].removesuffix(".")

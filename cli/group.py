"""A group of commands: its help by subject."""

from collections.abc import Iterator
from typing import Any

from typer.core import TyperGroup

HEADINGS = (
    *("One car", "Tables", "The line", "Where model and car disagree", "Files and settings"),
    *("Help", "Look", "Decide", "Hand out", "Commands"),
)
"""Headings of the help, in their order."""


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

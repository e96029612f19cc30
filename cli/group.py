"""A group of commands: its help by subject."""

from itertools import groupby
from typing import Any, NamedTuple

from typer.core import TyperGroup


class Row(NamedTuple):
    """A command in the help of its group."""

    heading: str
    name: str
    summary: str


class Group(TyperGroup):
    """Commands under their headings; a summary is never cut."""

    def rows(self) -> list[Row]:
        """Every command in the order of the help."""
        found: dict[str, Any] = dict(self.commands)
        return [Row(one.rich_help_panel, name, one.short_help) for name, one in found.items()]

    def list_commands(self, ctx: Any) -> list[str]:
        """Names of the commands in the order of the help."""
        return [row.name for row in self.rows()]

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write each subject with its commands."""
        width = max(len(row.name) for row in self.rows())
        for heading, rows in groupby(self.rows(), lambda row: row.heading):
            with formatter.section(heading):
                formatter.write_dl([(row.name.ljust(width), row.summary) for row in rows])


def first_sentence(text: str) -> str:
    r"""The first sentence of a help text, in one line and without its full stop.

    >>> first_sentence("Fit the table of a car.\n\nMore on it.")
    'Fit the table of a car'
    """
    paragraph = " ".join(text.strip().split("\n\n")[0].split())
    return paragraph.split(". ")[0].removesuffix(".")

"""Groups of commands, and the help that lists them under headings."""

from itertools import groupby
from typing import Any, NamedTuple

import typer
from typer.core import TyperGroup


class Row(NamedTuple):
    """A command in the help of its group: the heading above it, its name and its summary."""

    heading: str
    name: str
    summary: str


class Group(TyperGroup):
    """A group of commands, which its help lists under headings with whole summaries."""

    def rows(self) -> list[Row]:
        """Return every command in the order of the help."""
        commands: list[tuple[str, Any]] = list(self.commands.items())
        return [
            Row(command.rich_help_panel, name, command.short_help) for name, command in commands
        ]

    def list_commands(self, ctx: Any) -> list[str]:
        """Return the names of the commands in the order of the help."""
        return [row.name for row in self.rows()]

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write each heading with its commands."""
        width = max(len(row.name) for row in self.rows())
        for heading, rows in groupby(self.rows(), lambda row: row.heading):
            with formatter.section(heading):
                formatter.write_dl([(row.name.ljust(width), row.summary) for row in rows])


def first_sentence(text: str) -> str:
    r"""Return the first sentence of a help text, in one line and without its full stop.

    >>> first_sentence("Fit the table of a car.\n\nMore on it.")
    'Fit the table of a car'
    """
    paragraph = " ".join(text.strip().split("\n\n")[0].split())
    return paragraph.split(". ")[0].removesuffix(".")


def add(app: typer.Typer, heading: str, *commands: Any) -> None:
    """Add functions that `cli.command.command` declared to a group, under a heading of its help."""
    for function in commands:
        app.command(
            function.__name__.rstrip("_"),
            cls=function.cls,
            short_help=first_sentence(function.__doc__),
            epilog=example(*function.examples),
            rich_help_panel=heading,
        )(function)


def group(name: str, text: str, *examples: str, cls: Any = Group, **more: Any) -> typer.Typer:
    """Return a group without commands, with its help ``text`` and examples."""
    # without markup: typer's boxes import rich, which takes half of the time that --help may take
    app = typer.Typer(
        name=name,
        cls=cls,
        rich_markup_mode=None,
        add_completion=cls is not Group,  # the program alone has a class of its own
        no_args_is_help=True,
        short_help=first_sentence(text),
        epilog=example(*examples),
        **more,
    )
    app.callback(help=text)(_nothing)
    return app


def _nothing() -> None:
    """Do nothing; typer needs a callback to keep a group with one command a group."""


def example(*lines: str) -> str:
    """Return the end of a help text: ``lines`` that can be run in the folder of the demo."""
    return "\n".join(("\b", "Example:", *(f"  {line}" for line in lines)))

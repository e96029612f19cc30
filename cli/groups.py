"""Groups of commands, and the help that lists them under headings."""

from itertools import groupby
from typing import Any, NamedTuple

import typer
from typer.core import TyperGroup


class Row(NamedTuple):
    """A line of the help of a group, which lists a command."""

    heading: str  # above the line
    name: str
    summary: str


class Group(TyperGroup):
    """A group of commands. Its help lists them under headings, with whole summaries."""

    def rows(self) -> list[Row]:
        """Return every command in the order of the help."""
        commands: Any = self.commands
        return [Row(x.rich_help_panel, name, x.short_help) for name, x in commands.items()]

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
    """Add commands, declared by `cli.command.command`, to a group under a heading of its help."""
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
        add_completion=cls is not Group,  # only the whole program is of another class
        no_args_is_help=True,
        short_help=first_sentence(text),
        epilog=example(*examples),
        **more,
    )
    app.callback(help=text)(lambda: None)  # typer needs one for a group with a single command
    return app


def example(*lines: str) -> str:
    """Return the end of a help text, with ``lines`` that run in the folder of the demo."""
    return "\n".join(("\b", "Example:", *(f"  {line}" for line in lines)))  # \b keeps the lines

"""A group of commands: its help by subject, and -q and -v for each of its commands."""

from collections.abc import Iterator
from typing import Any

import typer
from typer.core import TyperGroup

from cli.loudness import loudness_options
from cli.options import example

SUBJECTS = {
    "brake-cal": {
        "One car": ("check", "fit", "validate", "plot"),
        "Tables": ("tables",),
        "The line": ("station", "limits", "repeatability", "batch", "watch", "fleet"),
        "Where model and car disagree": ("diagnose", "simulate", "effects"),
        "Files and settings": ("vehicle", "log", "map", "settings", "schema"),
        "Help": ("demo", "manual", "doctor", "qualify"),
    },
    "tables": {
        "Look": ("list", "find", "show", "diff", "log", "verify"),
        "Decide": ("release", "reject", "withdraw", "key", "sign"),
        "Hand out": ("export", "import"),
        "Make of others": ("merge",),
    },
}
"""Headings of the help by the name of the group, each with its commands in their order."""

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
    "brake-cal manual --html": "brake-cal manual PAGE",
    "tables derive": "brake-cal fit LOG...",
    **{f"brake-cal manual {old}": f"brake-cal manual {new}" for new in PAGES for old in PAGES[new]},
}
"""What there was once, as it is typed in a group, and the command to use instead."""


class Group(TyperGroup):
    """Commands under their `SUBJECTS`."""

    def __init__(self, **attributes: Any) -> None:
        super().__init__(**attributes)
        options = loudness_options()
        self.params = [*self.params, *options]
        for command in self.commands.values():
            command.short_help = first_sentence(command.help or "")
            if not isinstance(command, Group):
                command.params = [*command.params, *options]

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """Write each subject with its commands; a summary is never cut."""
        width = max(map(len, self.commands), default=0)
        for heading, names in self._subjects():
            rows = [(name.ljust(width), self.commands[name].short_help) for name in names]
            with formatter.section(heading):
                formatter.write_dl(rows)

    def _subjects(self) -> Iterator[tuple[str, list[str]]]:
        """Headings with the commands that there are; those of no subject under `Commands`."""
        subjects = SUBJECTS.get(self.name or "", {})
        for heading, named in subjects.items():
            there = [name for name in named if name in self.commands]
            if there:
                yield heading, there
        rest = [name for name in self.commands if name not in sum(subjects.values(), ())]
        if rest:
            yield "Commands", rest

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command that was typed; one that stands in a group below is named with its group."""
        typed = args[0]
        options = [word.partition("=")[0] for word in args[1:] if word.startswith("-")]
        for words in (typed, *(f"{typed} {word}" for word in (*args[1:2], *options))):
            if instead := GONE.get(f"{self.name} {words}"):
                ctx.fail(f"{words!r} is gone. Use '{instead}'.")
        if typed not in self.commands:
            groups = {k: x for k, x in self.commands.items() if isinstance(x, Group)}
            within = [f"'{k} {typed}'" for k, group in groups.items() if typed in group.commands]
            if within:
                ctx.fail(f"No such command {typed!r}. Did you mean {' or '.join(within)}?")
        return super().resolve_command(ctx, args)


def command_group(text: str, *examples: str) -> typer.Typer:
    """Return a group without commands: its help and examples."""
    # Plain help: typer's boxes import rich, which takes half of the time that --help may take.
    made = typer.Typer(
        cls=Group, rich_markup_mode=None, no_args_is_help=True, epilog=example(*examples)
    )
    made.callback(help=text)(_nothing)
    return made


def _nothing() -> None:
    """Stand for the group itself: without it a group of one command would be that command."""


def first_sentence(text: str) -> str:
    r"""The first sentence of a help text, in one line and without its full stop.

    >>> first_sentence("Fit the table of a car.\n\nMore on it.")
    'Fit the table of a car'
    """
    paragraph = " ".join(text.strip().split("\n\n")[0].split())
    return paragraph.split(". ")[0].removesuffix(".")

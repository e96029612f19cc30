"""Commands that are made when they are typed: the help of their group imports none of them."""

from collections.abc import Iterator
from importlib import import_module
from typing import Any, ClassVar

import typer

from cli.command import Group, Row, add


class LazyGroup(Group):
    """A group whose commands are somewhere else."""

    places: ClassVar[dict[Row, str]] = {}
    """Where each command is, as "module:function" or "module:group"."""

    def rows(self) -> list[Row]:
        """Every command in the order of the help."""
        return [*self.places]

    def get_command(self, ctx: Any, name: str) -> Any:
        """The command of a name, None for another name."""
        place = next((at for row, at in self.places.items() if row.name == name), None)
        if name not in self.commands and place is not None:
            self.commands[name] = _load(name, place)
        return super().get_command(ctx, name)

    def every(self) -> Iterator[tuple[str, Any]]:
        """Make every command."""
        return ((row.name, self.get_command(None, row.name)) for row in self.rows())

    def resolve_command(self, ctx: Any, args: list[str]) -> Any:
        """The command that was typed; the error for one of a subgroup names that group."""
        typed = args[0]
        if typed not in self.list_commands(ctx):
            groups = {name: one for name, one in self.every() if isinstance(one, Group)}
            within = [f"'{name} {typed}'" for name, one in groups.items() if typed in one.commands]
            if within:
                ctx.fail(f"No such command {typed!r}. Did you mean {' or '.join(within)}?")
        return super().resolve_command(ctx, args)


def _load(name: str, place: str) -> Any:
    """Import a command or a group from its place."""
    module, _, attribute = place.partition(":")
    group = getattr(import_module(module), attribute)
    if not isinstance(group, typer.Typer):
        command, group = group, typer.Typer(rich_markup_mode=None, add_completion=False)
        add(group, "", command)
    loaded: Any = typer.main.get_command(group)
    loaded.name = name
    return loaded

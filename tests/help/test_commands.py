"""The page `reference` names every command that there is."""

import re

import typer.main

from calib.help.page import FOLDER
from cli.main import app

PAGE = (FOLDER / "reference.md").read_text()


def rows() -> set[str]:
    """The commands of the first table: `tables list`, `show` is `tables list` and `tables show`."""
    table = PAGE.partition("## Exit codes")[0]
    found: set[str] = set()
    for cell in re.findall(r"^\| (`.*?) \|", table, flags=re.MULTILINE):
        words = re.findall(r"`([^`]+)`", cell)
        group = words[0].split()[0] if " " in words[0] else ""
        found |= {words[0], *(f"{group} {word}".strip() for word in words[1:])}
    return found


def test_every_command_is_in_the_table():
    known = rows()
    for name, command in typer.main.get_command(app).every():
        parts = getattr(command, "commands", {})
        assert name in known or {f"{name} {part}" for part in parts} <= known, name
        assert name in known or parts, name

"""Help by subject, whole summaries, and the options that all commands share."""

import pytest
import typer

from cli.group import SUBJECTS, Group, first_sentence
from cli.main import app

WIDTH = 80


def groups(group, path=()):
    yield path, group
    for name, inner in group.commands.items():
        if isinstance(inner, Group):
            yield from groups(inner, (*path, name))


GROUPS = dict(groups(typer.main.get_command(app)))
COMMANDS = [
    pytest.param(command, id=" ".join((*path, name)))
    for path, group in GROUPS.items()
    for name, command in group.commands.items()
]


@pytest.mark.parametrize("path", GROUPS, ids=lambda path: " ".join(("brake-cal", *path)))
def test_no_summary_is_cut_or_broken(brake_cal, monkeypatch, path):
    monkeypatch.setenv("COLUMNS", str(WIDTH))
    lines = brake_cal(*path, "--help").out.splitlines()
    for name, command in GROUPS[path].commands.items():
        (line,) = [one for one in lines if one.startswith(f"  {name} ")]
        assert line.split(maxsplit=1)[1] == first_sentence(command.help)
        assert len(line) < WIDTH


@pytest.mark.parametrize("name", SUBJECTS)
def test_every_command_has_a_subject(brake_cal, name):
    path = () if name == "brake-cal" else (name,)
    out = brake_cal(*path, "--help").out
    assert "\nCommands:\n" not in out
    told = [out.index(f"\n{heading}:\n") for heading in SUBJECTS[name]]
    assert told == sorted(told)


@pytest.mark.parametrize("command", COMMANDS)
def test_every_command_can_be_quiet_and_tell_more(command):
    options = {option for parameter in command.params for option in parameter.opts}
    assert {"-q", "--quiet", "-v", "--verbose"} <= options

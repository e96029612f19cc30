import sys
from pathlib import Path

import pytest
import typer.main

from calib import __version__
from calib.base.errors import BrakeCalError, InputError, StoreError
from calib.store.store import Store
from cli.main import app

ROOT = Path(__file__).parents[2]


def commands(group, path=()):
    """Every command of the app with its path, groups among them."""
    for name, command in getattr(group, "commands", {}).items():
        yield (*path, name), command
        yield from commands(command, (*path, name))


COMMANDS = dict(commands(typer.main.get_command(app)))


def test_version(brake_cal):
    assert brake_cal("--version").out == f"brake-cal {__version__}\n"


@pytest.mark.smoke
@pytest.mark.parametrize("path", [(), *COMMANDS], ids=" ".join)
def test_help_says_what_it_does_and_ends_with_an_example(brake_cal, path):
    ran = brake_cal(*path, "--help")
    assert ran.code == 0
    assert ran.err == ""
    before, _, example = ran.out.partition("  Example:\n")
    assert " ".join(("Usage: brake-cal", *path)) in before
    lines = example.strip().splitlines()
    assert lines
    assert all(line.strip().startswith("brake-cal ") for line in lines)


@pytest.mark.parametrize("path", [p for p, c in COMMANDS.items() if not hasattr(c, "commands")])
def test_every_command_has_json(path):
    assert any("--json" in option.opts for option in COMMANDS[path].params)


@pytest.mark.parametrize(
    ("arguments", "says"),
    [
        (("tabels",), "Did you mean 'tables'"),
        (("tables", "lst"), "Did you mean 'list'"),
        (("export", "car"), "Did you mean 'tables export'"),
        (("show",), "Did you mean 'vehicle show' or 'tables show'"),
        (("effects", "pad_fade"), "did you mean 'pad_thermal_fade'"),
        (("tables", "show"), "Missing argument"),
        (("tables", "list", "--stroe", "x"), "No such option"),
    ],
)
def test_usage_errors_end_with_2_and_help(brake_cal, arguments, says):
    ran = brake_cal(*arguments)
    assert ran.code == 2
    assert says in ran.err
    assert ran.out == ""


@pytest.mark.parametrize(
    ("error", "code"),
    [(BrakeCalError("w"), 1), (InputError("w", where="a.csv"), 3), (StoreError("w", do="mend"), 4)],
)
def test_an_error_is_a_line_on_stderr_and_an_exit_code(brake_cal, monkeypatch, error, code):
    def fail(self):
        raise error

    monkeypatch.setattr(Store, "list", fail)
    ran = brake_cal("tables", "list")
    assert (ran.code, ran.out, ran.err) == (code, "", f"error: {error}\n")


def test_a_bug_is_not_dressed_up(monkeypatch):
    def fail(self):
        raise ZeroDivisionError

    monkeypatch.setattr(Store, "list", fail)
    monkeypatch.setattr(sys, "argv", ["brake-cal", "tables", "list"])
    with pytest.raises(ZeroDivisionError):
        app()


def test_an_interrupt_ends_with_130(brake_cal, monkeypatch):
    def interrupt(self):
        raise KeyboardInterrupt

    monkeypatch.setattr(Store, "list", interrupt)
    assert brake_cal("tables", "list").code == 130

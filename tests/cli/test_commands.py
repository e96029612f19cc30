"""What every command has, in one loop over all of them; and what becomes of errors."""

import sys
from pathlib import Path

import jsonschema
import pytest
import typer.main

from calib import __version__
from calib.base.errors import BrakeCalError, InputError, StoreError
from calib.help.documents import documents
from calib.store.store import Store
from cli.groups import Group, first_sentence
from cli.main import app
from tests.cli.conftest import parsed

GROUP = typer.main.get_command(app)


def commands(group, path=()):
    for name in group.list_commands(None):
        command = group.get_command(None, name)
        yield (*path, name), command
        yield from commands(command, (*path, name)) if isinstance(command, Group) else ()


EVERY = dict(commands(GROUP))
COMMANDS = {path: c for path, c in EVERY.items() if not isinstance(c, Group)}


def test_there_are_no_more_than_36(brake_cal):
    assert len(COMMANDS) <= 36
    assert brake_cal("--version").out == f"brake-cal {__version__}\n"


@pytest.mark.smoke
@pytest.mark.parametrize("path", [(), *EVERY], ids=" ".join)
def test_help(brake_cal, monkeypatch, path):
    """It ends with examples; a group lists its commands by subject, each with a whole summary."""
    monkeypatch.setenv("COLUMNS", "80")
    ran = brake_cal(*path, "--help")
    assert (ran.code, ran.err) == (0, "")
    text, _, examples = ran.out.partition("  Example:\n")
    assert " ".join(("Usage: brake-cal", *path)) in text
    assert examples.strip()
    assert all(line.strip().startswith("brake-cal ") for line in examples.strip().splitlines())
    inner = {words[-1]: command for words, command in EVERY.items() if words[:-1] == path}
    for name, command in inner.items():
        assert f"\n  {name} " in text
        assert first_sentence(command.help) in " ".join(text.split())
    options = {o for p in (EVERY[path] if path else GROUP).params for o in p.opts}
    assert ({"-q", "-v", "--json"} <= options) == (path in COMMANDS)


@pytest.mark.parametrize("path", [("fit",), ("tables", "list"), ("watch",)], ids=" ".join)
def test_what_is_typed_wrong_ends_with_2_and_one_document(brake_cal, path):
    ran = brake_cal(*path, "--jsno", "--json")
    document = parsed(ran)
    jsonschema.validate(document, documents()["error"].schema)
    assert (ran.code, document["error"]["kind"]) == (2, "usage")


@pytest.mark.parametrize(
    ("words", "suggestion"),
    [
        (("tabels",), "'tables'"),
        (("effects", "pad_fade"), "'pad_thermal_fade'"),
        (("tables", "list", "--state", "relaesed"), "'released'"),
        (("batch", "validat", "x", "--out", "y"), "'validate'"),
    ],
)
def test_a_misspelt_name_is_answered_with_a_suggestion(brake_cal, words, suggestion):
    ran = brake_cal(*words)
    assert (ran.code, ran.out) == (2, "")
    assert suggestion in ran.err


@pytest.mark.parametrize(
    ("error", "kind", "code"),
    [
        (BrakeCalError("w"), "brake_cal", 1),
        (InputError("2 errors", where="car.toml", lines=("mass: missing", "h: text")), "input", 3),
        (StoreError("w", do="mend"), "store", 4),
    ],
)
def test_an_error_is_a_line_a_document_and_a_code(brake_cal, monkeypatch, error, kind, code):
    def fail(self, state):
        raise error

    monkeypatch.setattr(Store, "entries", fail)
    ran = brake_cal("tables", "list", "--json")
    document = parsed(ran)
    jsonschema.validate(document, documents()["error"].schema)
    assert (ran.code, ran.err) == (code, f"error: {error}\n")
    assert (document["error"]["kind"], document["error"]["lines"]) == (kind, [*error.lines])
    assert brake_cal("tables", "list").out == ""
    assert brake_cal("tables", "list", "--", "--json").out == ""  # a file of that name


def test_a_bug_is_not_dressed_up_and_an_interrupt_ends_with_130(brake_cal, monkeypatch):
    def fail(self, state):
        raise raised

    monkeypatch.setattr(Store, "entries", fail)
    raised = KeyboardInterrupt()
    assert brake_cal("tables", "list").code == 130
    raised = ZeroDivisionError()
    monkeypatch.setattr(sys, "argv", ["brake-cal", "tables", "list"])
    with pytest.raises(ZeroDivisionError):
        app()


OURS = Path(__file__).parents[2] / "sample_logs" / "sedan"
STORED = ("--store", OURS.parents[1] / "tables")
RAMP, CAR = OURS / "ramp_wet_asphalt.csv", ("--vehicle", OURS / "vehicle.toml")
FILES = {
    "limits": ("limits",),
    "log": ("log", RAMP),
    "plot": ("plot", "sedan-2up", "--figure", "f1-f2", *STORED),
    "simulate": ("simulate", "--manoeuvre", "stop", *CAR),
    "export": ("tables", "export", "sedan-2up", *STORED),
}
ENDINGS = {"limits": "toml", "plot": "svg", "export": "dcm"}


@pytest.mark.parametrize("name", FILES)
def test_a_foreign_file_is_replaced_with_force_only(brake_cal, tmp_path, name):
    out = tmp_path / f"out.{ENDINGS.get(name, 'csv')}"
    words = (*FILES[name], "--out", out)
    out.write_text("mine")
    ran = brake_cal(*words)
    assert (ran.code, ran.result, out.read_text()) == (2, "", "mine")
    assert brake_cal(*words, "--force").code == 0
    content = out.read_bytes()
    assert content != b"mine"
    assert brake_cal(*words).code == 0  # our own, once more
    assert out.read_bytes() == content
    out.unlink()
    out.mkdir()
    assert brake_cal(*words, "--force").code == 2
    blocked = tmp_path / "file"
    blocked.write_text("mine")
    assert brake_cal(*words[:-1], blocked / out.name).code == 2
    assert {p.name for p in tmp_path.iterdir()} == {out.name, "file"}


FOLDERS = {
    "validate": ("validate", "sedan-2up", OURS / "coast.csv", *STORED),
    "batch": ("batch", "check", OURS),
    "demo": ("demo",),
}


@pytest.mark.parametrize("name", FOLDERS)
@pytest.mark.parametrize("below", ["", "deeper"])
def test_a_file_is_no_folder(brake_cal, tmp_path, name, below):
    (tmp_path / "file").write_text("mine")
    ran = brake_cal(*FOLDERS[name], "--out", tmp_path / "file" / below)
    assert (ran.code, ran.result) == (2, ""), ran.err
    assert (tmp_path / "file").read_text() == "mine"


@pytest.mark.parametrize("name", ["log", "station"])
def test_no_output_replaces_an_input(brake_cal, tmp_path, name):
    log = tmp_path / ("dry_asphalt_stop.parquet" if name == "station" else "a.csv")
    source = OURS / "dry_asphalt_stop.csv"
    if log.suffix == ".csv":
        log.write_bytes(source.read_bytes())
    else:
        assert brake_cal("log", source, "--out", log).code == 0
    content = log.read_bytes()
    words = {
        "log": ("log", log, "--force", "--out", log),
        "station": ("station", RAMP, log, *CAR, "--out", tmp_path),
    }[name]
    ran = brake_cal(*words)
    assert (ran.code, ran.result) == (2, "")
    assert log.read_bytes() == content

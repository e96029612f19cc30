"""A log from stdin, and what is refused of it."""

import io
import json
import sys

import pytest

from calib.help.samples import sample_logs
from calib.store.store import Store

SEDAN = sample_logs() / "sedan"
STOP = SEDAN / "basalt_wet_pads.csv"


class Stdin:
    """What a pipe brings."""

    def __init__(self, data, terminal=False):
        self.buffer, self.terminal = io.BytesIO(data), terminal

    def isatty(self):
        return self.terminal


@pytest.fixture
def piped(brake_cal, monkeypatch):
    def run(*words, data=None, terminal=False):
        monkeypatch.setattr(sys, "stdin", Stdin(data or STOP.read_bytes(), terminal))
        return brake_cal(*words)

    return run


def test_a_piped_log_is_found_as_its_file(piped):
    (found,) = json.loads(piped("check", "-", "--json").out)["logs"]
    (file,) = json.loads(piped("check", STOP, "--json").out)["logs"]
    assert (found.pop("log"), found.pop("source")) == ("stdin", "stdin.csv")
    assert {**found, "warnings": 0} == {k: file[k] for k in found} | {"warnings": 0}


def test_a_result_is_named_after_it(piped, fitted, tmp_path):
    Store(tmp_path / "tables").save(fitted)
    ran = piped(
        *("validate", "sedan-2up", "-", "--store", tmp_path / "tables", "--out", tmp_path / "out")
    )
    assert ran.code == 0
    assert sorted(p.name for p in (tmp_path / "out").iterdir()) == ["stdin.parquet", "summary.json"]


def test_it_can_be_looked_at_cut_and_converted(piped, tmp_path):
    (found,) = json.loads(piped("log", "view", "-", "--json").out)["logs"]
    assert (found["log"], found["source"]) == ("stdin", "stdin.csv")
    ran = piped("log", "cut", "-", "--to", 2, "--out", tmp_path / "a.csv", "-v")
    assert (ran.code, "read stdin.csv: 2027 rows, time, p_mc" in ran.err) == (0, True)
    assert piped("log", "convert", "-", "--out", tmp_path, "--to", "parquet").code == 0
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.csv", "stdin.parquet"]
    assert piped("log", "convert", "-", "-", "--out", tmp_path, "--to", "csv").code == 2


@pytest.mark.parametrize(
    ("words", "code", "says"),
    [
        (("check", "-", "-"), 2, "give - once"),
        (("fit", "-", "--vehicle", SEDAN / "vehicle.toml"), 2, "give a file, not -"),
        (("station", "-", STOP, "--vehicle", SEDAN / "vehicle.toml"), 2, "give a file, not -"),
    ],
)
def test_where_a_log_must_have_a_name_it_is_refused(piped, tmp_path, words, code, says):
    more = ("--out", tmp_path / "out") if words[0] == "station" else ()
    ran = piped(*words, *more)
    assert (ran.code, ran.result) == (code, "")
    assert says in ran.err


def test_a_terminal_is_no_log_and_a_pipe_has_a_bound(piped, monkeypatch):
    assert "stdin is a terminal" in piped("check", "-", terminal=True).err
    monkeypatch.setenv("BRAKE_CAL_MOST_LOG", "0.001")
    ran = piped("check", "-")
    assert ran.code == 3
    assert "BRAKE_CAL_MOST_LOG" in ran.err


def test_another_format_on_stdin_is_named(piped):
    ran = piped("check", "-", data=b"(1700000000.000400) can0 101#0000D4FF5F750000\n")
    assert ran.code == 3
    assert "stdin holds a candump log; expected CSV" in ran.err
    assert "a file that ends in .log" in ran.err

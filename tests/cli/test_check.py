"""`brake-cal check`, and a log from stdin."""

import io
import sys
from pathlib import Path
from types import SimpleNamespace

import pytest

from calib.logs.write import write_csv
from tests.cli.conftest import parsed
from tests.support.made_runs import changed, made_run

SEDAN = Path(__file__).parents[2] / "sample_logs/sedan"
STOP = SEDAN / "basalt_wet_pads.csv"
CAR = ("--vehicle", SEDAN / "vehicle.toml")


def test_a_log_is_usable_useless_or_unreadable(brake_cal, tmp_path, monkeypatch):
    monkeypatch.delenv("COLUMNS")
    write_csv(changed(made_run(), p_mc=None), tmp_path / "useless.csv")
    coast, useless, none = SEDAN / "coast.csv", tmp_path / "useless.csv", tmp_path / "none.csv"
    for logs, code in (((coast,), 0), ((coast, useless), 1), ((none, useless, coast), 3)):
        document = parsed(ran := brake_cal("check", *logs, "--json"))
        assert ran.code == code
        assert document["logs"][-1]["log"] in ("coast", "useless")
        assert len(document["logs"]) + len(document["unreadable"]) == len(logs)
        assert ("error" in document) == (code == 3)
        assert len(brake_cal("check", *logs).out.splitlines()) == len(document["logs"])


@pytest.fixture
def piped(brake_cal, monkeypatch):
    def run(*words, data=None, terminal=False):
        monkeypatch.setattr(
            sys,
            "stdin",
            SimpleNamespace(buffer=io.BytesIO(data or STOP.read_bytes()), isatty=lambda: terminal),
        )
        return brake_cal(*words)

    return run


def test_a_piped_log_is_read_as_its_file(piped, tmp_path):
    (found,) = parsed(piped("check", "-", "--json"))["logs"]
    (file,) = parsed(piped("check", STOP, "--json"))["logs"]
    assert (found.pop("log"), found.pop("source")) == ("stdin", "stdin.csv")
    assert {**found, "warnings": 0} == {k: file[k] for k in found} | {"warnings": 0}
    assert piped("log", "-", "--until", 2, "--out", tmp_path / "a.csv").code == 0
    assert [p.name for p in tmp_path.iterdir()] == ["a.csv"]


def test_a_terminal_another_format_and_too_much_are_no_log(piped, monkeypatch):
    assert piped("check", "-", terminal=True).code == 3
    assert piped("check", "-", data=b"(1700000000.0004) can0 101#0000D4FF5F750000\n").code == 3
    monkeypatch.setenv("BRAKE_CAL_MOST_LOG", "0.001")
    assert "BRAKE_CAL_MOST_LOG" in piped("check", "-").err

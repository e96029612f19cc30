"""Whatever nobody caught ends with a code of its own, which no verdict has."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

from tests.cli.conftest import parsed

ROOT = Path(__file__).parents[2]
SEDAN = ROOT / "sample_logs" / "sedan"


@pytest.mark.parametrize("error", [MemoryError(), ZeroDivisionError("division by zero")])
def test_the_program_itself_fails_with_6(brake_cal, monkeypatch, error):
    def fail(*_: object, **__: object) -> None:
        raise error

    monkeypatch.setattr("calib.logs.read.open_log", fail)
    ran = brake_cal("check", SEDAN / "coast.csv", "--json")
    assert ran.code == parsed(ran)["error"]["exit_code"] == 6
    assert "Traceback" not in ran.err
    assert ran.err.count("error: ") == 1


def test_a_station_that_crashes_gives_no_verdict(brake_cal, monkeypatch, tmp_path):
    def fail(*_: object, **__: object) -> None:
        raise MemoryError

    monkeypatch.setattr("calib.line.station.station.judged_car", fail)
    out = tmp_path / "out"
    words = ("--vehicle", SEDAN / "vehicle.toml", "--out", out, "--store", tmp_path / "tables")
    ramp, stop = SEDAN / "ramp_wet_asphalt.csv", SEDAN / "basalt_wet_pads.csv"
    ran = brake_cal("station", ramp, stop, *words, "--serial", "7")
    assert ran.code == 6
    document = json.loads((out / "refused.json").read_text())
    assert (document["error"]["exit_code"], document["identity"]["serial"]) == (6, "7")
    assert [path.name for path in out.iterdir()] == ["refused.json"]


def test_a_working_folder_that_is_gone_is_a_mistake_of_usage(tmp_path):
    home = tmp_path / "gone"
    home.mkdir()
    run = "import os, sys; os.rmdir(os.getcwd()); from cli.main import main; main()"
    words = [sys.executable, "-c", run, "log", str(SEDAN / "coast.csv"), "--out", "page.html"]
    env = {**os.environ, "PYTHONPATH": os.pathsep.join([str(ROOT), *sys.path[1:]])}
    ran = subprocess.run(words, cwd=home, env=env, capture_output=True, text=True, check=False)
    assert ran.returncode == 2
    assert ran.stderr.count("error: ") == 1
    assert "Traceback" not in ran.stderr

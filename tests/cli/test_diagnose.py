"""`brake-cal diagnose` as the shell runs it."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pytest

from calib.help.samples import sample_logs
from tests.cli.conftest import parsed

CASE = sample_logs() / "hidden" / "case_0"
SEARCHED = [CASE / "calibration" / name for name in ("coast.parquet", "ramp.parquet")]
HOLDOUTS = [CASE / "holdout" / name for name in ("stop_a.parquet", "mixed.parquet")]
VEHICLE = CASE / "vehicle.toml"


@pytest.fixture
def run(brake_cal):
    def diagnose(*words, stops=tuple(HOLDOUTS)):
        return brake_cal("diagnose", *SEARCHED, "--holdout", *stops, "--vehicle", VEHICLE, *words)

    return diagnose


def test_one_holdout_option_takes_every_log_after_it_and_all_is_written(run, tmp_path):
    out = tmp_path / "found"
    ran = run("--out", out, "--json")
    assert ran.code == 0
    document = parsed(ran)
    assert document == json.loads((out / "diagnosis.json").read_text())
    hidden = json.loads((CASE / "answer.json").read_text())
    assert [effect["name"] for effect in document["effects"]] == hidden["effects"]
    files = {str(p.relative_to(out)) for p in out.rglob("*") if p.is_file()}
    sims = {f"sim/{when}/{p.stem}.csv" for when in ("before", "after") for p in HOLDOUTS}
    assert files == {"diagnosis.json", "model.toml", "report.html"} | sims


def test_a_log_that_is_searched_and_held_out_proves_nothing(run, tmp_path):
    ran = run("--out", tmp_path / "found", stops=(SEARCHED[0],))
    assert ran.code == 3
    assert not list(tmp_path.iterdir())


@pytest.mark.parametrize("send", [os.kill, os.killpg], ids=["itself", "with its workers"])
def test_stopped_it_says_so_in_a_line_and_leaves_nothing(tmp_path, send):
    words = ["diagnose", *SEARCHED, "--holdout", *HOLDOUTS, "--vehicle", VEHICLE, "--workers", "2"]
    process = subprocess.Popen(
        [sys.executable, "-m", "cli.main", *map(str, words), "--out", str(tmp_path / "found")],
        cwd=Path(__file__).parents[2],
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    assert process.stderr.readline().startswith("searching")
    send(process.pid, signal.SIGTERM)
    _, err = process.communicate(timeout=60)  # ends when no process holds stderr
    assert process.returncode == 130
    # a signal within the line above may write that once more
    assert err.removeprefix("searching 2 logs, confirming on 2\n").count("\n") == 1
    assert not list(tmp_path.iterdir())

"""`brake-cal watch` as a service of a bench: started, ended, killed."""

import json
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from tests.support.fleet_logs import many
from tests.support.fleet_results import journalled
from tests.support.reference_car import REAL, noisy, stop

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def logs(tmp_path_factory):
    folder = many(tmp_path_factory.mktemp("made") / "logs", [noisy(stop(REAL), 3)], 6)
    return sorted(folder.iterdir())


@pytest.fixture
def bench(tmp_path):
    """Start a watch over tmp_path/in in processes of its own; it has begun when this returns."""
    (tmp_path / "in").mkdir()
    running = []

    def start(*more):
        words = ("check", "in", "--out", "out", "--workers", "1", "--every", "0.1", "--settle")
        process = subprocess.Popen(
            [sys.executable, "-m", "cli.main", "watch", *words, "0.2", *more],
            cwd=tmp_path,
            env={**os.environ, "PYTHONPATH": str(ROOT)},
            stdout=subprocess.PIPE,
            stderr=subprocess.PIPE,
            text=True,
            start_new_session=True,
        )
        running.append(process)
        assert process.stderr.readline().startswith("watching in")
        return process

    yield start
    for process in running:
        process.kill()
        process.communicate()


def drop(logs, folder):
    for log in logs:
        (folder / log.name).write_bytes(log.read_bytes())


def waited_for(question, patience=60.0):
    end = time.monotonic() + patience
    while time.monotonic() < end:
        if question():
            return
        time.sleep(0.05)
    raise AssertionError("waited in vain")


@pytest.mark.parametrize("send", [os.kill, os.killpg], ids=["itself", "with its workers"])
@pytest.mark.parametrize("number", [signal.SIGTERM, signal.SIGINT])
def test_it_ends_when_asked_and_says_what_was_done(bench, logs, tmp_path, number, send):
    process = bench("--json")
    drop(logs[:2], tmp_path / "in")
    told = [json.loads(process.stdout.readline()) for _ in range(2)]
    send(process.pid, number)
    out, err = process.communicate(timeout=30)
    assert (process.returncode, out) == (0, ""), err
    assert [row["log"] for row in told] == ["car_00000.csv", "car_00001.csv"]
    assert told[0]["figures"]["usable_validate"] is True
    assert "2 passed; out/results.parquet" in err
    assert pq.read_table(tmp_path / "out" / "results.parquet").num_rows == 2


def test_killed_and_started_again_each_log_is_done_once(bench, logs, tmp_path):
    process = bench()
    drop(logs, tmp_path / "in")
    told = [process.stdout.readline() for _ in range(2)]
    process.kill()
    told += process.communicate()[0].splitlines()
    kept = journalled(tmp_path / "out")
    assert {line.split(":")[0] for line in told} <= set(kept)
    process = bench()
    again = [process.stdout.readline().split(":")[0] for _ in range(6 - len(kept))]
    waited_for((tmp_path / "out" / "results.parquet").exists)
    process.terminate()
    rest, _ = process.communicate(timeout=30)
    assert (process.returncode, rest) == (0, "")
    assert sorted([*kept, *again]) == [log.name for log in logs]
    assert sorted(journalled(tmp_path / "out")) == [log.name for log in logs]


def test_mistakes(brake_cal, tmp_path):
    ran = brake_cal("watch", "check", tmp_path / "nowhere", "--out", tmp_path / "out")
    assert ran.code == 2
    assert "nowhere" in ran.err
    ran = brake_cal("watch", "diagnose", tmp_path, "--out", tmp_path / "out")
    assert ran.code == 2
    assert "brake-cal batch" in ran.err
    ran = brake_cal("watch", "validate", tmp_path, "--out", tmp_path / "out")
    assert ran.code == 2
    assert "--table" in ran.err
    ran = brake_cal("watch", "validat", tmp_path, "--out", tmp_path / "out")
    assert ran.code == 2
    assert "did you mean 'validate'" in ran.err
    assert not (tmp_path / "out").exists()

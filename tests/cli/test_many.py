"""`brake-cal batch`, `watch` and `fleet`."""

import json
import os
import signal
import subprocess
import sys
from pathlib import Path

import pyarrow as pa
import pyarrow.parquet as pq
import pytest

from calib.estimation.metrics import METRICS
from calib.store.store import Store
from tests.cli.conftest import parsed
from tests.support.fleet_logs import many
from tests.support.fleet_results import results
from tests.support.reference_car import CAR, REAL, SEDAN, WET, cut, noisy, stop

ROOT = Path(__file__).parents[2]
TABLE = ("--table", CAR.name)


@pytest.fixture(scope="module")
def home(tmp_path_factory, fitted):
    """A table of the car in tables/, and three logs of which one will not do in logs/."""
    home = tmp_path_factory.mktemp("home")
    wet = noisy(stop(WET), 3)
    Store(home / "tables").save(fitted)
    many(home / "logs", [wet, noisy(stop(REAL), 4), cut(wet, 1.8)], 3)
    return home


@pytest.fixture
def batch(brake_cal, home, monkeypatch):
    monkeypatch.chdir(home)
    return lambda command, *words, out: brake_cal(
        "batch", command, *words, "--out", out, "--workers", "2"
    )


def rows(out):
    return pq.read_table(out / "results.parquet").to_pylist()


def test_validate_and_its_limits(batch, tmp_path):
    ran = batch("validate", "logs", *TABLE, "--json", out=tmp_path / "out")
    assert ran.code == 0
    assert parsed(ran)["counts"] == {"passed": 2, "failed": 0, "done": 0, "error": 1}
    schema = pq.read_schema(tmp_path / "out/results.parquet")
    assert schema.names == ["log", "digest", "status", "error", *METRICS, "not_held", "warned"]
    assert all(field.metadata[b"unit"] for field in schema)
    ran = batch("validate", "logs", *TABLE, "--json", out=tmp_path / "out")
    assert parsed(ran)["done_now"] == 0
    limits = ("--limits", tmp_path / "limits.toml")
    limits[1].write_text("schema = 1\n[limits]\ninterval_f = { max = 1e-6 }\n")
    assert batch("validate", "logs", *TABLE, *limits, out=tmp_path / "out").code == 2  # others
    assert batch("validate", "logs", *TABLE, *limits, out=tmp_path / "strict").code == 1
    broken = [row["not_held"] for row in rows(tmp_path / "strict")]
    assert broken == ["interval_f", "interval_f", None]


def test_fit_check_and_what_cannot_be_read(batch, tmp_path):
    sedan = [SEDAN / "ramp_wet_asphalt.csv", SEDAN / "coast.csv"]
    assert batch("fit", *sedan, "--vehicle", SEDAN / "vehicle.toml", out=tmp_path / "fit").code == 0
    coast, ramp = rows(tmp_path / "fit")
    assert (coast["status"], ramp["status"]) == ("error", "done")
    assert 0.3 < ramp["pad_friction_f"] < 0.5
    (tmp_path / "bad.csv").write_text("nonsense\n")
    assert batch("check", tmp_path / "bad.csv", out=tmp_path / "out").code == 3
    assert rows(tmp_path / "out")[0]["error"].startswith(str(tmp_path / "bad.csv"))
    assert batch("check", tmp_path / "nowhere", out=tmp_path / "none").code == 3
    assert not (tmp_path / "none").exists()


@pytest.mark.parametrize(
    "words",
    [
        ("batch", "validate", "logs"),
        ("batch", "fit", "logs"),
        ("batch", "check", "logs", *TABLE),
        ("batch", "check", "logs", "--workers", "1", "--scheduler", "tcp://127.0.0.1:1"),
    ],
)
def test_usage(brake_cal, batch, tmp_path, words):
    assert brake_cal(*words, "--out", tmp_path / "out").code == 2
    assert not (tmp_path / "out").exists()


@pytest.fixture
def bench(tmp_path):
    """Start a watch over tmp_path/in in processes of its own; it has begun when this returns."""
    (tmp_path / "in").mkdir()
    running = []

    def start(*more):
        words = ("check", "in", "--out", "out", "--workers", "1", "--settle")
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


def drop(home, folder, count):
    for log in sorted((home / "logs").iterdir())[:count]:
        (folder / log.name).write_bytes(log.read_bytes())


@pytest.mark.parametrize("send", [os.kill, os.killpg], ids=["itself", "with its workers"])
def test_a_watch_ends_when_asked(bench, home, tmp_path, send):
    process = bench("--json")
    drop(home, tmp_path / "in", 2)
    rows_ = [json.loads(process.stdout.readline()) for _ in range(2)]
    send(process.pid, signal.SIGTERM)
    out, _ = process.communicate(timeout=60)
    assert (process.returncode, out) == (0, "")
    assert [row["log"] for row in rows_] == ["car_00000.csv", "car_00001.csv"]
    assert rows_[0]["figures"]["usable_validate"] is True
    assert pq.read_table(tmp_path / "out" / "results.parquet").num_rows == 2


def test_a_fleet_is_written_and_told(brake_cal, tmp_path):
    folder = tmp_path / os.fsdecode(b"fr\xfch")  # a title that is not UTF-8
    folder.mkdir()
    digests = ([*"abacbbd", None], pa.string(), None)
    path = results(folder / "r.parquet", 8, extra={"digest": digests})
    out = tmp_path / "out"
    ran = brake_cal("fleet", path, "--out", out)
    assert ran.code == 0, ran.err
    assert {p.name for p in out.iterdir()} == {"fleet.json", "report.html"}
    document = json.loads((out / "fleet.json").read_text())
    assert (document["logs"], len(document["copies"])) == (8, 2)

"""What is computed again in a batch and what is not, and logs that kill a worker."""

import os
import pickle
import subprocess
import sys
from pathlib import Path

import pyarrow.parquet as pq
import pytest

from calib.base.errors import BatchError
from calib.estimation.limits import Limit
from calib.estimation.metrics import METRICS
from calib.estimation.validate import validate_one
from calib.line.fleet.batch import run_batch
from calib.line.fleet.journal import NAME
from calib.line.fleet.work import Job
from calib.logs.channel_map import ChannelMap, Mapping
from calib.logs.read import read_log
from calib.logs.text.dialect import TextFormat
from tests.support.fleet_logs import Here, validating
from tests.support.fleet_results import journalled

ROOT = Path(__file__).parents[3]


@pytest.fixture
def job(fitted):
    return validating(fitted)


@pytest.fixture
def run(job):
    """Run the job of the test, or another one, on some logs."""

    def run(*arguments, executor=None, job=job, **more):
        return run_batch(job, arguments, Path("out"), executor or Here(), **more)

    return run


def rows_of(batch):
    return pq.read_table(batch.results).to_pylist()


def test_rows_are_those_of_validate_to_the_last_bit(job, run, six):
    batch = run(six)
    assert batch.counts == {"error": 2, "passed": 4}
    rows = rows_of(batch)
    assert [row["log"] for row in rows] == [f"logs/car_{i:05d}.csv" for i in range(6)]
    for row in rows:
        log = read_log(Path(row["log"]))
        assert row["digest"] == log.digest
        if row["status"] == "passed":
            alone = validate_one(job.table, log, None, job.limits).figures
            assert {name: row[name] for name in METRICS} == alone
        else:
            assert row["error"].startswith(row["log"])
            assert all(row[name] is None for name in METRICS)


def test_only_a_log_that_changed_or_is_new_or_cannot_be_read_is_done_again(run, six):
    first = run(six, "logs/*.csv", "logs/car_00000.csv", "logs/missing.csv")
    assert (first.counts.total(), first.finished, first.total) == (7, 7, 7)
    files = (first.results, Path("out", NAME))
    contents = [file.read_bytes() for file in files]
    again = run(six, "logs/missing.csv")
    assert (again.computed, again.counts) == (1, first.counts)
    assert [file.read_bytes() for file in files] == contents

    Path("logs/car_00002.csv").write_bytes(Path("logs/car_00000.csv").read_bytes())
    Path("logs/new.csv").write_bytes(Path("logs/car_00001.csv").read_bytes())
    Path("logs/car_00005.csv").unlink()
    os.mkfifo("logs/missing.csv")
    batch = run(six, "logs/missing.csv")
    rows = {row["log"]: row for row in rows_of(batch)}
    assert batch.computed == 3
    assert rows["logs/car_00002.csv"]["status"] == rows["logs/new.csv"]["status"] == "passed"
    assert "logs/car_00005.csv" not in rows
    assert rows["logs/missing.csv"]["digest"] is None
    assert "pipe" in rows["logs/missing.csv"]["error"]  # why it cannot be read now


def test_other_settings_are_refused(run, fitted, six):
    results = run(six).results.read_bytes()
    strict = Job("validate", table=fitted, limits=(Limit("interval_f", None, 1e-6),))
    with pytest.raises(BatchError):
        run(six, job=strict)
    assert Path("out/results.parquet").read_bytes() == results


def test_a_log_that_kills_its_worker_is_a_row_and_is_tried_again(run, six):
    executor = Here(lambda name: name.endswith("3.csv"))
    rows = rows_of(run(six, executor=executor))
    assert executor.renewed == 2
    bad = rows.pop(3)
    assert (bad["status"], bad["digest"]) == ("error", None)
    again = run(six)
    assert again.computed == 1
    assert again.counts == {"error": 2, "passed": 4}
    all_rows = rows_of(again)
    del all_rows[3]
    assert rows == all_rows


def test_a_worker_of_another_version_ends_the_run(run, six, fitted):
    with pytest.raises(BatchError):
        run(six, job=Job("validate", table=fitted, version="0.0.0"))


MAPS = (
    {"channels": {"p_mc": Mapping("p")}},
    {"channels": {"p_mc": Mapping("p", unit="bar")}},
    {"text": TextFormat(decimal=",")},
    {"databases": lambda file: {"": (file,)}},
)


def test_all_that_a_channel_map_says_is_a_setting(tmp_path):
    bus = tmp_path / "a.dbc"
    bus.write_text("VERSION 1")

    def settings(**fields):
        fields = {"channels": {}, **fields}
        if "databases" in fields:
            fields["databases"] = fields["databases"](bus)
        return Job("check", channel_map=ChannelMap("m.toml", **fields)).settings()["map"]

    digests = [settings(), *(settings(**fields) for fields in MAPS)]
    bus.write_text("VERSION 2")
    digests.append(settings(**MAPS[-1]))
    assert len(set(digests)) == len(digests) == 6


# A batch that says how far it is.
BATCH = """
import pickle, sys
from pathlib import Path
from calib.line.fleet.batch import run_batch
from calib.line.fleet.workers import Pool

if __name__ == "__main__":
    job, logs, out = pickle.loads(sys.stdin.buffer.read())
    run_batch(job, [logs], Path(out), Pool(1), lambda batch: print(batch.finished, flush=True))
"""


def test_kill_9_in_the_middle_and_again(fitted, fleet, undisturbed, tmp_path):
    psutil = pytest.importorskip("psutil")
    out, script = tmp_path / "out", tmp_path / "batch.py"
    script.write_text(BATCH)
    process = subprocess.Popen(
        [sys.executable, script],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    )
    process.stdin.write(pickle.dumps((validating(fitted), str(fleet), str(out))))
    process.stdin.close()
    reported = next(int(line) for line in process.stdout if int(line) >= 4)
    workers = psutil.Process(process.pid).children(recursive=True)
    process.kill()
    process.wait()
    process.stdout.close()
    assert reported <= len(journalled(out)) < 24
    assert not (out / "results.parquet").exists()
    assert psutil.wait_procs(workers, timeout=20)[1] == [], "workers outlive their parent"

    again = run_batch(validating(fitted), [str(fleet)], out, Here())
    assert again.computed < 24
    assert again.results.read_bytes() == undisturbed

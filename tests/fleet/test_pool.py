"""Real processes: the same bytes for any number of them, after kill -9 of one or of all."""

import os
import signal
import subprocess
import sys
import time
from concurrent.futures import BrokenExecutor, Future
from multiprocessing import active_children
from pathlib import Path

import pytest

from calib.fleet import pool as module
from calib.fleet.journal import NAME
from calib.fleet.pool import Pool
from calib.fleet.run import run_batch
from calib.table.store import Store
from tests.support.fleet_logs import Here, validating

ROOT = Path(__file__).parents[2]


@pytest.fixture(scope="module")
def undisturbed(fitted, sixty, tmp_path_factory):
    """results.parquet of the sixty logs, made without processes."""
    return run_batch(
        validating(fitted), [str(sixty)], tmp_path_factory.mktemp("whole"), Here()
    ).results.read_bytes()


@pytest.mark.parametrize("workers", [1, 3])
def test_the_same_bytes_for_any_number_of_workers(
    fitted, sixty, undisturbed, tmp_path, workers, monkeypatch
):
    monkeypatch.setattr(module, "LIFETIME", 20)  # renewed twice or more
    pool = Pool(workers)
    try:
        done = run_batch(validating(fitted), [str(sixty)], tmp_path, pool)
    finally:
        pool.close()
    assert done.counts == {"error": 20, "passed": 40}
    assert done.results.read_bytes() == undisturbed


def test_a_killed_worker_costs_no_row(fitted, sixty, undisturbed, tmp_path):
    pool, killed = Pool(2), []

    def report(pace):
        if pace.done >= 10 and not killed:
            killed.append(active_children()[0].pid)
            os.kill(killed[0], signal.SIGKILL)

    try:
        done = run_batch(validating(fitted), [str(sixty)], tmp_path, pool, report)
    finally:
        pool.close()
    assert killed
    assert done.results.read_bytes() == undisturbed
    assert len((tmp_path / NAME).read_bytes().splitlines()) == 1 + 60


def test_a_pool_that_breaks_while_logs_are_handed_over_costs_no_row(
    fitted, sixty, undisturbed, tmp_path
):
    class Breaks(Here):
        broken = False

        def submit(self, packed: bytes, items: tuple[module.Item, ...]) -> "Future[module.Rows]":
            if len(self.done) >= 20 and not self.broken:
                self.broken = True
                raise BrokenExecutor("broke a moment ago")
            return super().submit(packed, items)

    done = run_batch(validating(fitted), [str(sixty)], tmp_path, Breaks())
    assert done.results.read_bytes() == undisturbed


def test_kill_9_in_the_middle_and_again(fitted, sixty, undisturbed, tmp_path):
    psutil = pytest.importorskip("psutil")
    Store(tmp_path / "tables").save(fitted)
    out = tmp_path / "out"
    command = [sys.executable, "-m", "cli.main", "batch", "validate", sixty]
    command += ["--table", fitted.name, "--store", tmp_path / "tables", "--out", out]
    command += ["--workers", "1"]
    process = subprocess.Popen(command, cwd=ROOT, stdout=subprocess.PIPE, stderr=subprocess.PIPE)
    while process.poll() is None and rows_in(out) < 8:
        time.sleep(0.002)
    workers = psutil.Process(process.pid).children(recursive=True)
    process.kill()
    process.communicate()
    before = rows_in(out)
    assert 8 <= before < 60
    assert not (out / "results.parquet").exists()
    assert psutil.wait_procs(workers, timeout=20)[1] == [], "workers outlive their parent"

    again = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert again.returncode == 0, again.stderr
    assert "60 logs: 20 error, 40 passed" in again.stdout
    names = [line.split(b",")[0] for line in (out / NAME).read_bytes().splitlines()[1:]]
    assert len(names) == len(set(names)) == 60
    assert (out / "results.parquet").read_bytes() == undisturbed


def rows_in(out):
    """Whole rows in the journal."""
    path = out / NAME
    return max(path.read_bytes().count(b"\n") - 1, 0) if path.exists() else 0

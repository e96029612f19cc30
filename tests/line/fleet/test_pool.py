"""Real processes: the same bytes for any number of them, after kill -9 of one or of all."""

import os
import pickle
import signal
import subprocess
import sys
from concurrent.futures import BrokenExecutor, Future
from multiprocessing import active_children
from pathlib import Path

import pytest

from calib.line.fleet import workers as module
from calib.line.fleet.batch import run_batch
from calib.line.fleet.workers import Pool
from calib.store.store import Store
from tests.support.fleet_logs import Here, validating
from tests.support.fleet_results import journalled

ROOT = Path(__file__).parents[3]


@pytest.fixture(scope="module")
def undisturbed(fitted, sixty, tmp_path_factory):
    """results.parquet of the sixty logs, made without processes."""
    return run_batch(
        validating(fitted), [str(sixty)], tmp_path_factory.mktemp("whole"), Here()
    ).results.read_bytes()


@pytest.mark.parametrize("workers", [1, 3])
def test_the_same_bytes_for_any_number_of_workers(fitted, sixty, undisturbed, tmp_path, workers):
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
    assert len(journalled(tmp_path)) == 60


def test_a_pool_that_breaks_while_logs_are_handed_over_costs_no_row(
    fitted, sixty, undisturbed, tmp_path
):
    class Breaks(Here):
        broken = False

        def submit(
            self, packed: bytes, items: tuple[module.WorkItem, ...]
        ) -> "Future[module.Rows]":
            if len(self.done) >= 20 and not self.broken:
                self.broken = True
                raise BrokenExecutor("broke a moment ago")
            return super().submit(packed, items)

    done = run_batch(validating(fitted), [str(sixty)], tmp_path, Breaks())
    assert done.results.read_bytes() == undisturbed


# A batch that says how far it is, and on which workers.
BATCH = """
import pickle, sys
from pathlib import Path
from calib.line.fleet.workers import Pool
from calib.line.fleet.batch import run_batch

if __name__ == "__main__":
    job, logs, out = pickle.loads(sys.stdin.buffer.read())
    run_batch(job, [logs], Path(out), Pool(1), lambda pace: print(pace.done, flush=True))
"""


def test_kill_9_in_the_middle_and_again(fitted, sixty, undisturbed, tmp_path):
    psutil = pytest.importorskip("psutil")
    Store(tmp_path / "tables").save(fitted)
    out = tmp_path / "out"
    command = [sys.executable, "-m", "cli.main", "batch", "validate", sixty]
    command += ["--table", fitted.name, "--store", tmp_path / "tables", "--out", out]
    command += ["--workers", "1"]
    script = tmp_path / "batch.py"
    script.write_text(BATCH)
    process = subprocess.Popen(
        [sys.executable, script],
        env={**os.environ, "PYTHONPATH": str(ROOT)},
        stdin=subprocess.PIPE,
        stdout=subprocess.PIPE,
    )
    process.stdin.write(pickle.dumps((validating(fitted), str(sixty), str(out))))
    process.stdin.close()
    said = next(int(line) for line in process.stdout if int(line) >= 8)
    workers = psutil.Process(process.pid).children(recursive=True)
    process.kill()
    process.wait()
    process.stdout.close()
    assert said <= len(journalled(out)) < 60
    assert not (out / "results.parquet").exists()
    assert psutil.wait_procs(workers, timeout=20)[1] == [], "workers outlive their parent"

    again = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
    assert again.returncode == 0, again.stderr
    assert "60 logs: 20 error, 40 passed" in again.stdout
    assert len(journalled(out)) == 60
    assert (out / "results.parquet").read_bytes() == undisturbed

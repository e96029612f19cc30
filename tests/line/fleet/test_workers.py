"""Two worker processes, of this machine or of a real Dask scheduler, one of them killed."""

import os
import pickle
import signal
import subprocess
import sys
import time
from contextlib import closing
from importlib.util import find_spec
from pathlib import Path

import pytest

from calib.line.fleet.batch import run_batch
from calib.line.fleet.workers import Pool
from tests.support.fleet_logs import validating

with_dask = pytest.mark.skipif(not find_spec("distributed"), reason="without the extra `dist`")

ROOT = Path(__file__).parents[3]
LOCAL = ("--host", "127.0.0.1", "--no-dashboard")

# In a process of its own: what the cluster logs and warns of stays there.
DRIVE = """
import os, pickle, signal, sys
from pathlib import Path
from calib.line.fleet.workers import Cluster
from calib.line.fleet.batch import run_batch

job, logs, out, address, victim = pickle.loads(sys.stdin.buffer.read())
def report(run):
    global victim
    if run.finished >= 4 and victim:
        os.kill(victim, signal.SIGKILL)
        print("killed after", run.finished)
        victim = None
cluster = Cluster(address)
cluster._client.wait_for_workers(2, timeout=30)
assert cluster.workers == 2
run_batch(job, [logs], Path(out), cluster, report)
cluster.close()
"""


def started(*arguments):
    environment = {**os.environ, "PYTHONPATH": str(ROOT)}
    return subprocess.Popen(
        [sys.executable, "-m", *map(str, arguments)],
        cwd=ROOT,
        env=environment,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )


@pytest.fixture
def cluster(tmp_path):
    """Address of a scheduler, and two workers; without a nanny, a killed one stays away."""
    file, cli = tmp_path / "scheduler.json", "distributed.cli.dask_"
    processes = [started(f"{cli}scheduler", *LOCAL, "--port", 0, "--scheduler-file", file)]
    worker = (f"{cli}worker", *LOCAL, "--scheduler-file", file, "--no-nanny", "--nthreads", 1)
    processes += [started(*worker), started(*worker)]
    yield waited_for(lambda: file.exists() and address_in(file.read_text())), processes[1:]
    for process in processes:
        process.kill()
        process.wait()


def address_in(text):
    return text.partition('"address": "')[2].partition('"')[0]


def waited_for(question, patience=30.0):
    end = time.monotonic() + patience
    while time.monotonic() < end:
        if answer := question():
            return answer
        time.sleep(0.05)
    raise AssertionError("waited in vain")


def test_a_killed_process_of_this_machine_costs_no_row(fitted, fleet, undisturbed, tmp_path):
    killed = []

    def report(run):
        if run.finished >= 4 and not killed:
            killed.append(next(iter(pool._pool._processes)))
            os.kill(killed[0], signal.SIGKILL)

    with closing(Pool(2)) as pool:
        batch = run_batch(validating(fitted), [str(fleet)], tmp_path / "out", pool, report)
    assert killed
    assert batch.results.read_bytes() == undisturbed


@with_dask
def test_a_killed_worker_costs_no_row(fitted, fleet, undisturbed, cluster, tmp_path):
    (address, workers), out = cluster, tmp_path / "out"
    message = pickle.dumps((validating(fitted), str(fleet), str(out), address, workers[0].pid))
    ran = subprocess.run(
        [sys.executable, "-c", DRIVE], cwd=ROOT, input=message, capture_output=True, timeout=120
    )
    assert ran.returncode == 0, ran.stderr.decode()
    assert b"killed after" in ran.stdout
    assert workers[0].wait(10) == -signal.SIGKILL
    assert workers[1].poll() is None
    assert (out / "results.parquet").read_bytes() == undisturbed


@with_dask
@pytest.mark.parametrize("address", ["tcp://127.0.0.1:9", "nonsense"])
def test_the_command_says_that_nobody_answers(tmp_path, fleet, address):
    code = (
        "import sys; from calib.line.fleet import workers; workers._TIMEOUT = '1s'; "
        "from cli.main import main; main()"
    )
    words = ["batch", "check", str(fleet), "--out", str(tmp_path / "out")]
    words += ["--scheduler", address]
    ran = subprocess.run(
        [sys.executable, "-c", code, *words], cwd=ROOT, capture_output=True, text=True
    )
    assert ran.returncode == 2
    assert "Traceback" not in ran.stderr
    assert not (tmp_path / "out").exists()

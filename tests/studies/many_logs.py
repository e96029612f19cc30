"""What a batch of many logs asks of the machine that hands them out, and a restart after kill -9.

The workers are simulated, each log costs nothing: journal, memory and results of the coordinator
are those of the program. The first run is killed in the middle and the restart does what is left,
of which CPU and memory are given.

    python -m tests.studies.many_logs 1000 10000 100000 > tests/studies/results/many_logs.md
"""

import os
import resource
import signal
import subprocess
import sys
import tempfile
from concurrent.futures import Future
from hashlib import sha256
from pathlib import Path

import pyarrow.parquet as pq

from calib.line.fleet.batch import BatchRun, run_batch
from calib.line.fleet.rows import Command, Row, Status, columns_of
from calib.line.fleet.work import Job, WorkItem
from calib.line.fleet.workers import Rows
from tests.support.fleet_logs import Here
from tests.support.fleet_results import journalled

HEAD = "| logs | rows when killed | rows of the restart | rows at the end | CPU [s] | peak [MB] |"


class Simulated(Here):
    """An executor whose rows cost nothing; a log that has its digest is not done again."""

    def submit(self, packed: bytes, items: tuple[WorkItem, ...]) -> Future[Rows]:
        """Rows as those of `validate`."""
        future: Future[Rows] = Future()
        future.set_result([row_of(item) for item in items])
        return future


def row_of(item: WorkItem) -> Row | None:
    """A row by the name of the log."""
    digest = sha256(item.name.encode()).hexdigest()
    numbers = (int(digest[:8], 16) / k for k in range(1, len(columns_of(Command.VALIDATE)) - 1))
    row = Row(item.name, digest, Status.PASSED, None, (*numbers, None, None))
    return None if digest == item.digest else row


def run(folder: Path, ends_at: int) -> None:
    """One run; it prints its rows, seconds of CPU and memory, or kills itself."""

    def report(sweep: BatchRun) -> None:
        if sweep.finished >= ends_at > 0:
            os.kill(os.getpid(), signal.SIGKILL)

    job = Job(Command.VALIDATE)
    sweep = run_batch(job, [str(folder / "logs")], folder / "out", Simulated(), report)
    used = resource.getrusage(resource.RUSAGE_SELF)
    print(sweep.computed, used.ru_utime + used.ru_stime, used.ru_maxrss / 1024)


def study(count: int) -> str:
    """Kill a run of ``count`` logs in the middle and start it again; a line of the table."""
    with tempfile.TemporaryDirectory() as home:
        folder = Path(home)
        (folder / "logs").mkdir()
        for i in range(count):
            (folder / "logs" / f"car_{i:06d}.csv").touch()
        words = [sys.executable, "-m", "tests.studies.many_logs", "--run", home]
        assert subprocess.run([*words, str(count // 2)]).returncode == -signal.SIGKILL
        finished = len(journalled(folder / "out"))
        output = subprocess.run([*words, "0"], stdout=subprocess.PIPE, check=True).stdout.split()
        again, seconds, peak = map(float, output)
        rows = pq.read_metadata(folder / "out" / "results.parquet").num_rows
    return f"| {count:,} | {finished:,} | {again:,.0f} | {rows:,} | {seconds:.0f} | {peak:.0f} |"


if __name__ == "__main__":
    if "--run" in sys.argv:
        run(Path(sys.argv[2]), int(sys.argv[3]))
    else:
        print("# A batch of many logs, with workers that cost nothing", "", sep="\n")
        print(HEAD, "|---" * 6 + "|", sep="\n")
        for words in sys.argv[1:]:
            print(study(int(words)), flush=True)

"""Run a batch: find the logs, compute their rows in chunks, and write the results.

find_logs ──> chunks of a few logs ──> workers ──> journal ──> results.parquet
                                         └── if a worker died: its logs again, one at a time

A worker skips a log whose digest is that of a row in the journal.
"""

import glob
import os
import pickle
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import ALL_COMPLETED, FIRST_COMPLETED, BrokenExecutor, Future, wait
from contextlib import closing
from itertools import islice
from pathlib import Path

from calib.base.errors import BrakeCalError, LogError, printable
from calib.line.fleet.journal import BatchJournal
from calib.line.fleet.results import NAME, write_results
from calib.line.fleet.rows import Command, Row, Status
from calib.line.fleet.work import Job, WorkItem
from calib.line.fleet.workers import Executor, Rows
from calib.logs.read import FORMATS

_CHUNK = {Command.FIT: 2, Command.VALIDATE: 8, Command.CHECK: 8}
"""Largest number of logs in a chunk: so many that the time of the transfer is negligible."""
_CHUNKS_PER_WORKER = 3  # submitted chunks for each worker: one in progress, two waiting


def run_batch(
    job: Job,
    arguments: Sequence[str],
    out: Path,
    executor: Executor,
    report: Callable[["BatchRun"], None] = lambda run: None,
) -> "BatchRun":
    """Run the job on the logs of ``arguments``, see `find_logs`; write ``out``/results.parquet.

    An earlier run with the same settings is continued. ``report`` is called after each chunk.
    Raises LogError when an argument names no log, BatchError when ``out`` holds another batch or
    the workers are of another version, OSError when ``out`` cannot be written.
    """
    logs = {printable(path): path for path in find_logs(arguments, out)}
    settings = job.settings()
    with closing(BatchJournal(out, settings)) as journal:
        run = BatchRun(job, journal, executor, len(logs), report)
        run.work(logs.items())
        write_results(journal.rows(sorted(logs)), settings, out)
        return run


class BatchRun:
    """A run over ``total`` logs: it submits the logs to workers and writes rows into the journal.

    ``counts`` has the number of rows by status, ``computed`` the number of rows that this run made.
    ``report`` is called with the run after each chunk, ``on_row`` with each new row.
    """

    def __init__(
        self,
        job: Job,
        journal: BatchJournal,
        executor: Executor,
        total: int,
        report: Callable[["BatchRun"], None] = lambda run: None,
        on_row: Callable[[Row], None] = lambda row: None,
    ):
        self.packed, self.largest_chunk = pickle.dumps(job), _CHUNK[job.command]
        self.journal, self.executor, self.total = journal, executor, total
        self.report, self.on_row = report, on_row
        self.pending: dict[Future[Rows], tuple[WorkItem, ...]] = {}
        self.results = journal.folder / NAME
        self.counts, self.computed = Counter[Status](), 0

    @property
    def finished(self) -> int:
        """The number of logs with a row."""
        return self.counts.total()

    def document(self) -> dict[str, object]:
        """Return the counts as plain data."""
        return {
            "results": self.results,
            "logs": self.finished,
            "counts": {status: self.counts[status] for status in Status},
            "done_now": self.computed,
        }

    def work(self, logs: Iterable[tuple[str, str]]) -> None:
        """Compute all ``logs``, each as (name of the log in its row, path)."""
        # of few logs the chunks are small, so that all workers get some
        size = min(self.largest_chunk, 1 + self.total // (8 * self.executor.workers))
        digest = self.journal.digest
        items = (WorkItem(log, os.path.abspath(path), digest(log)) for log, path in logs)
        while chunk := tuple(islice(items, size)):
            self._drain(_CHUNKS_PER_WORKER * self.executor.workers - 1)
            self.pending[self._submit(chunk)] = chunk
        self._drain(0)

    def _submit(self, chunk: tuple[WorkItem, ...]) -> Future[Rows]:
        """Submit a chunk; return a failed future if the pool just broke."""
        try:
            return self.executor.submit(self.packed, chunk)
        except BrokenExecutor as error:
            future: Future[Rows] = Future()
            future.set_exception(error)
            return future

    def _drain(self, unfinished: int) -> None:
        """Store finished rows until at most ``unfinished`` chunks are pending."""
        while len(self.pending) > unfinished:
            lost = self._gather(FIRST_COMPLETED)
            if lost:
                # a pool that lost one worker loses all pending chunks
                lost += self._gather(ALL_COMPLETED)
                self.executor.renew()
                for item in lost:
                    self._store((item,), self._retry(item))

    def _gather(self, until: str) -> list[WorkItem]:
        """Wait, store the rows of finished chunks, and return the logs whose worker died."""
        lost: list[WorkItem] = []
        for future in wait(self.pending, return_when=until).done:
            items = self.pending.pop(future)
            if _worker_error(future):
                lost += items
            else:
                self._store(items, future.result())
        return lost

    def _retry(self, item: WorkItem) -> Rows:
        """Repeat a log alone after its worker died. Its row is an error if a worker dies again."""
        future = self._submit((item,))
        error = _worker_error(future)
        if error is None:
            return future.result()
        self.executor.renew()
        problem = f"the worker died on it twice ({type(error).__name__})"
        text = f"{item.name}: {problem}; is there enough memory? the next run tries it again"
        return [Row(item.name, None, Status.ERROR, text, lost=True)]

    def _store(self, items: tuple[WorkItem, ...], rows: Rows) -> None:
        """Store the rows of a chunk, and count them. An unchanged log is in the journal already."""
        computed = [row for row in rows if row is not None]
        # a log that cannot be read has no digest and is tried in every run, often with an equal row
        new = [row for row in computed if row.digest or self.journal.row(row.log) != row]
        self.journal.add(new)
        self.computed += len(computed)
        unchanged = [item.name for item, row in zip(items, rows, strict=True) if row is None]
        self.counts.update(row.status for row in (*computed, *self.journal.rows(unchanged)))
        self.report(self)
        for row in new:
            self.on_row(row)


def _worker_error(future: Future[Rows]) -> BaseException | None:
    """Return why the worker died, None if it lives. Raises an error that a user can correct."""
    error = future.exception()
    if isinstance(error, BrakeCalError):
        raise error
    return error


def find_logs(arguments: Iterable[str], out: Path) -> Iterator[str]:
    """Yield the paths of the logs, relative for a relative argument. A path may come twice.

    An argument is a file, a pattern, or a folder with all logs in it and below. Hidden files, the
    results in ``out``, and all of an ``out`` within a folder are left out. A missing file with the
    ending of a log gets a row with an error. Raises LogError for an argument without a log.
    """
    results = os.path.realpath(out / NAME)
    for argument in arguments:
        # an existing path is no pattern, nor is the name of a missing log
        is_path = os.path.exists(argument) or (_is_log(argument) and not glob.has_magic(argument))
        matches = [argument] if is_path else sorted(glob.iglob(argument, recursive=True))
        paths: list[str] = []
        for path in matches:
            if os.path.isdir(path):
                paths += logs_below(path, out)
            elif path == argument or (_is_log(path) and os.path.realpath(path) != results):
                paths.append(path)
        if not paths:
            expected = f"files that end in {', '.join(FORMATS)}"
            do = "check the path; put a pattern in quotes"
            raise LogError("no log found", where=argument, expected=expected, do=do)
        yield from paths


def _refuse(error: OSError) -> None:
    raise LogError(f"cannot be read ({error.strerror})", where=error.filename) from error


def logs_below(
    folder: str, out: Path, on_error: Callable[[OSError], None] = _refuse
) -> Iterator[str]:
    """Yield the paths of the logs in a folder and below, possibly none, as `find_logs` does."""
    for place, folders, files in os.walk(folder, onerror=on_error):  # skips the folder of an error
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        is_out = os.path.realpath(place) == os.path.realpath(out)
        if is_out and place != folder:
            folders.clear()
            continue
        for name in sorted(files):
            if _is_log(name) and not (is_out and name == NAME):
                yield os.path.join(place, name)


def _is_log(path: str) -> bool:
    name = os.path.basename(path)
    return name.lower().endswith(FORMATS) and not name.startswith(".")

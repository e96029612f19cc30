"""Run a batch: find logs, skip finished ones, compute the others in chunks, write the results.

find ──> [a limited number of chunks] ──> workers ──> journal ──> results.parquet
                           └── if a worker died: its logs again, one at a time
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
"""Most logs in a chunk: so many that the transfer is negligible compared to 10 ms for each log."""

_CHUNKS_PER_WORKER = 3
"""Submitted chunks for each worker: one in progress, the others waiting."""


def run_batch(
    job: Job,
    arguments: Sequence[str],
    out: Path,
    executor: Executor,
    report: Callable[["BatchRun"], None] = lambda run: None,
) -> "BatchRun":
    """Run the job on every log that ``arguments`` name and write ``out``/results.parquet.

    Continues an earlier run with the same settings. Raises LogError when an argument names no log,
    BatchError when ``out`` holds another batch or the workers are not of this version, OSError when
    ``out`` cannot be written.
    """
    logs = {printable(path): path for path in find_logs(arguments, out)}
    settings = job.settings()
    with closing(BatchJournal(out, settings)) as journal:
        run = BatchRun(job, journal, executor, len(logs), report)
        run.work(logs.items())
        write_results(journal.rows(sorted(logs)), settings, out)
        return run


class BatchRun:
    """Submits ``total`` logs to the workers, and writes their rows into the journal.

    ``counts`` of rows by status so far, ``computed`` of them now and the others earlier; ``report``
    is called with the run after each chunk, ``on_row`` with each new row.
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
        self.packed, self.journal, self.executor = pickle.dumps(job), journal, executor
        self.most, self.total, self.report, self.on_row = _CHUNK[job.command], total, report, on_row
        self.pending: dict[Future[Rows], tuple[WorkItem, ...]] = {}
        self.results, self.counts = journal.folder / NAME, Counter[Status]()
        self.computed = 0

    @property
    def finished(self) -> int:
        """Return the number of logs with a row."""
        return self.counts.total()

    def document(self) -> dict[str, object]:
        """The counts as plain data."""
        return {
            "results": self.results,
            "logs": self.finished,
            "counts": {status: self.counts[status] for status in Status},
            "done_now": self.computed,
        }

    def work(self, logs: Iterable[tuple[str, str]]) -> None:
        """Compute all ``logs``, each as (name of its row, path)."""
        # small chunks of few logs, so that all workers have some
        size = min(self.most, 1 + self.total // (8 * self.executor.workers))
        items = (
            WorkItem(name, os.path.abspath(path), self.journal.digest(name)) for name, path in logs
        )
        while chunk := tuple(islice(items, size)):
            self._drain(_CHUNKS_PER_WORKER * self.executor.workers - 1)
            self.pending[self._submit(chunk)] = chunk
        self._drain(0)

    def _submit(self, chunk: tuple[WorkItem, ...]) -> Future[Rows]:
        """Submit a chunk; if the pool just broke, return a failed future."""
        try:
            return self.executor.submit(self.packed, chunk)
        except BrokenExecutor as error:
            future: Future[Rows] = Future()
            future.set_exception(error)
            return future

    def _drain(self, most: int) -> None:
        """Wait until at most ``most`` chunks are unfinished, and store finished rows."""
        while len(self.pending) > most:
            suspects = self._gather(FIRST_COMPLETED)
            if suspects:
                # a pool that lost one worker loses all unfinished logs
                suspects += self._gather(ALL_COMPLETED)
                self.executor.renew()
                for item in suspects:
                    self._store((item,), self._retry(item))

    def _gather(self, until: str) -> list[WorkItem]:
        """Store the rows of finished chunks; return the logs whose worker died."""
        suspects: list[WorkItem] = []
        for future in wait(self.pending, return_when=until).done:
            items = self.pending.pop(future)
            if _worker_error(future):
                suspects += items
            else:
                self._store(items, future.result())
        return suspects

    def _retry(self, item: WorkItem) -> Rows:
        """Repeat the log of a dead worker, alone; an error if the worker dies again."""
        future = self._submit((item,))
        error = _worker_error(future)
        if error is None:
            return future.result()
        self.executor.renew()
        text = f"{item.name}: the worker died on it twice ({type(error).__name__}); is there "
        text += "enough memory? the next run tries it again"
        return [Row(item.name, None, Status.ERROR, text, lost=True)]

    def _store(self, items: tuple[WorkItem, ...], rows: Rows) -> None:
        """Store the rows of a chunk; an unchanged log already has its row in the journal."""
        computed = [row for row in rows if row is not None]
        # a log that cannot be read has no digest: it is tried each time
        new = [r for r in computed if r.digest is not None or self.journal.row(r.log) != r]
        self.journal.add(new)
        self.computed += len(computed)
        stored = (item.name for item, row in zip(items, rows, strict=True) if row is None)
        self.counts.update(row.status for row in (*computed, *self.journal.rows(stored)))
        self.report(self)
        for row in new:
            self.on_row(row)


def _worker_error(future: Future[Rows]) -> BaseException | None:
    """Why the worker died, None if it did not. Raises what a user can correct."""
    error = future.exception()
    if isinstance(error, BrakeCalError):
        raise error
    return error


def find_logs(arguments: Iterable[str], out: Path) -> Iterator[str]:
    """Paths of the logs, relative where the argument is; one may come twice.

    A folder means all logs in it and below. Hidden files, the results in ``out``, and all of an
    ``out`` within a folder are left out. Raises LogError for an argument without a log; a missing
    file with the ending of a log is returned, and gets a row with an error.
    """
    results = os.path.realpath(out / NAME)
    for argument in arguments:
        named = os.path.exists(argument) or (_is_log(argument) and not glob.has_magic(argument))
        paths: list[str] = []
        for path in [argument] if named else sorted(glob.iglob(argument, recursive=True)):
            if os.path.isdir(path):
                paths += logs_below(path, out)
            elif named or _is_log(path):
                paths += [path] * (named or os.path.realpath(path) != results)
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
    """Paths of the logs in a folder and below, possibly none. Else like `find_logs`.

    ``on_error`` is called if a folder cannot be read; the folder is then skipped.
    """
    for place, folders, files in os.walk(folder, onerror=on_error):
        folders[:] = sorted(f for f in folders if not f.startswith("."))
        has_results = os.path.realpath(place) == os.path.realpath(out)
        if has_results and place != folder:
            folders.clear()
        else:
            logs = (f for f in sorted(files) if _is_log(f) and not (has_results and f == NAME))
            yield from (os.path.join(place, f) for f in logs)


def _is_log(path: str) -> bool:
    name = os.path.basename(path)
    return name.lower().endswith(FORMATS) and not name.startswith(".")

"""Run a batch: find logs, skip finished ones, compute the others in chunks, write the results.

find ──> todo ──> [a limited number of chunks]     ──> journal ──> results.parquet
                           └── if a worker died: its logs again, one at a time
"""

import os
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from dataclasses import dataclass
from pathlib import Path

from calib.base.errors import BrakeCalError
from calib.base.printable import printable
from calib.line.fleet.columns import Status
from calib.line.fleet.command import Command
from calib.line.fleet.find import find_logs
from calib.line.fleet.job import Job
from calib.line.fleet.journal import BatchJournal, open_journal
from calib.line.fleet.pace import Pace
from calib.line.fleet.pool import Executor, Rows
from calib.line.fleet.results import write_results
from calib.line.fleet.row import Row
from calib.line.fleet.work import WorkItem

CHUNK = {Command.FIT: 2, Command.VALIDATE: 8, Command.CHECK: 8, Command.DIAGNOSE: 1}
"""Most logs in a chunk: so many that the transfer is negligible compared to 10 ms for each log."""

AHEAD = 3
"""Submitted chunks for each worker: one in progress and the others waiting."""

SYNC = 2.0
"""Longest time until finished rows are forced to the disk [s]."""

Report = Callable[[Pace], None]


@dataclass(frozen=True)
class Batch:
    """Result of a run: ``counts`` of rows by status, path of the results, and speed."""

    results: Path
    counts: Counter[Status]
    pace: Pace

    @property
    def total(self) -> int:
        """Number of rows."""
        return self.counts.total()

    @property
    def unreadable(self) -> bool:
        """Whether no log has a result."""
        return self.counts[Status.ERROR] == self.total

    @property
    def failed(self) -> bool:
        """Whether a log fails its limits."""
        return self.counts[Status.FAILED] > 0

    def document(self) -> dict[str, object]:
        """Counts of all statuses, and data on this run, as plain data."""
        return {
            "counts": {status: self.counts[status] for status in Status},
            "done_now": self.pace.fresh,
            "seconds": self.pace.elapsed,
            "logs_per_second": self.pace.rate,
        }


def run_batch(
    job: Job,
    arguments: Sequence[str],
    out: Path,
    executor: Executor,
    report: Report = lambda pace: None,
    fresh: bool = False,
) -> Batch:
    """Run the job on every log that ``arguments`` name and write ``out``/results.parquet.

    Continues an earlier run with the same settings; ``fresh`` starts again. A log that fails gets a
    row. Raises LogError when an argument names no log, BatchError when ``out`` holds
    another batch or the workers are not of this version, OSError when ``out`` cannot be written.
    """
    total = sum(1 for _ in find_logs(arguments, job.command, out))
    out.mkdir(parents=True, exist_ok=True)
    settings = job.settings()
    journal = open_journal(out, settings, fresh)
    try:
        sweep = Sweep(job, journal, executor, report, total)
        sweep.work((printable(p), p) for p in find_logs(arguments, job.command, out))
        journal.sync()
        path = write_results(journal.rows(sorted(sweep.wanted)), settings, out)
        return Batch(path, sweep.counts, sweep.pace())
    finally:
        journal.close()


class Sweep:
    """Submits logs to the workers, and writes their rows into the journal.

    ``report`` is called with the pace after each chunk, ``tell`` with its new rows once they are in
    the journal. ``total`` logs are expected.
    """

    def __init__(
        self,
        job: Job,
        journal: BatchJournal,
        executor: Executor,
        report: Report,
        total: int,
        tell: Callable[[list[Row]], None] = lambda rows: None,
    ):
        self.packed, self.journal, self.executor = job.packed(), journal, executor
        self.command, self.report, self.total, self.tell = job.command, report, total, tell
        self.wanted: set[str] = set()
        self.pending: dict[Future[Rows], tuple[WorkItem, ...]] = {}
        self.counts: Counter[Status] = Counter()
        self.fresh = 0
        self.start = self.synced = time.monotonic()

    def pace(self) -> Pace:
        """The progress so far."""
        elapsed = time.monotonic() - self.start
        errors = self.counts[Status.ERROR]
        return Pace(self.total, self.counts.total(), self.fresh, errors, elapsed)

    def work(self, logs: Iterable[tuple[str, str]]) -> None:
        """Compute all ``logs``, each as (name of its row, path)."""
        for chunk in self._chunks(logs):
            if self.executor.worn:
                self._drain(0)
                self.executor.renew()
            self._drain(AHEAD * self.executor.workers - 1)
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

    def _chunks(self, logs: Iterable[tuple[str, str]]) -> Iterator[tuple[WorkItem, ...]]:
        """Small chunks first, so that few logs are spread over all workers."""
        chunk: list[WorkItem] = []
        begun = 0
        for name, path in logs:
            if name in self.wanted:  # two patterns match it
                self.total -= 1
                continue
            self.wanted.add(name)
            chunk.append(WorkItem(name, os.path.abspath(path), self._known(name)))
            if len(chunk) >= min(CHUNK[self.command], 1 + begun // (8 * self.executor.workers)):
                begun += len(chunk)
                yield tuple(chunk)
                chunk = []
        if chunk:
            yield tuple(chunk)

    def _known(self, name: str) -> str | None:
        """Digest of the row of a log, if it has one that is not ``lost``."""
        row = self.journal.row(name)
        return None if row is None or row.lost else row.digest

    def _drain(self, most: int) -> None:
        """Wait until at most ``most`` chunks are unfinished, and store finished rows."""
        while len(self.pending) > most:
            finished, _ = wait(self.pending, return_when=FIRST_COMPLETED)
            suspects = self._gather(finished)
            if suspects:
                self._alone(suspects)

    def _gather(self, finished: Iterable[Future[Rows]]) -> list[WorkItem]:
        """Store the rows of finished chunks; return the logs whose worker died."""
        suspects: list[WorkItem] = []
        for future in finished:
            items = self.pending.pop(future)
            try:
                rows = future.result()
            except BrakeCalError:
                raise
            except Exception:
                suspects += items
            else:
                self._keep(items, rows)
        return suspects

    def _alone(self, suspects: list[WorkItem]) -> None:
        """Repeat the logs of dead workers one at a time; an error for one that kills again."""
        # a pool that lost one worker loses all unfinished logs
        suspects += self._gather(wait(self.pending).done)
        self.executor.renew()
        for item in suspects:
            try:
                rows = self.executor.submit(self.packed, (item,)).result()
            except BrakeCalError:
                raise
            except Exception as error:
                text = f"{item.name}: the worker died on it twice ({type(error).__name__})"
                hint = "; is there enough memory? the next run tries it again"
                rows = [Row(item.name, None, Status.ERROR, text + hint, lost=True)]
                self.executor.renew()
            self._keep((item,), rows)

    def _keep(self, items: tuple[WorkItem, ...], rows: Rows) -> None:
        """Store the rows of a chunk; an unchanged log already has its row in the journal."""
        new = [row for row in rows if row is not None and not self._same(row)]
        self.journal.add(new)
        self.fresh += sum(row is not None for row in rows)
        stored = (item.name for item, row in zip(items, rows, strict=True) if row is None)
        self.counts.update(row.status for row in (*filter(None, rows), *self.journal.rows(stored)))
        if time.monotonic() - self.synced > SYNC:
            self.journal.sync()
            self.synced = time.monotonic()
        self.report(self.pace())
        if new:
            self.tell(new)

    def _same(self, row: Row) -> bool:
        """Whether a log could not be read before either, with the same row."""
        return row.digest is None and self.journal.row(row.log) == row

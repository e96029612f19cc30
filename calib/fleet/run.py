"""Run a batch: find, skip what is done, do the rest a few at a time, write the results.

find ──> todo ──> [at most a few chunks under way] ──> journal ──> results.parquet
                           └── a chunk whose worker died: its logs again, one at a time
"""

import os
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from dataclasses import dataclass
from pathlib import Path

from calib.errors import BrakeCalError
from calib.files import printable
from calib.fleet.columns import Status
from calib.fleet.command import Command
from calib.fleet.find import find_logs
from calib.fleet.job import Job
from calib.fleet.journal import Journal, open_journal
from calib.fleet.pace import Pace
from calib.fleet.pool import Executor, Rows
from calib.fleet.results import write_results
from calib.fleet.row import Row
from calib.fleet.work import Item

CHUNK = {Command.FIT: 2, Command.VALIDATE: 8, Command.CHECK: 8, Command.DIAGNOSE: 1}
"""Most logs in one hand-over: enough that handing over costs nothing beside 10 ms a log."""

AHEAD = 3
"""Chunks under way for each worker: one at work and some in hand."""

SYNC = 2.0
"""Seconds after which finished rows are forced to the disk."""

Report = Callable[[Pace], None]


@dataclass(frozen=True)
class Batch:
    """The end of a run: ``counts`` of rows by status, where they are, and how fast it went."""

    results: Path
    counts: Counter[Status]
    pace: Pace

    @property
    def total(self) -> int:
        """Rows."""
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
        """Counts of all statuses, and what this run did, as plain data."""
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
    """Do every log that ``arguments`` name and write ``out``/results.parquet.

    Goes on where an earlier run with the same settings stopped; ``fresh`` begins anew. A log that
    fails is a row. Raises LogError when an argument names no log, BatchError when ``out`` holds
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
    """Logs handed out, and their rows as they come back into the journal.

    ``report`` is called with the pace after each chunk, ``tell`` with its new rows once they are in
    the journal. ``total`` logs are expected.
    """

    def __init__(
        self,
        job: Job,
        journal: Journal,
        executor: Executor,
        report: Report,
        total: int,
        tell: Callable[[list[Row]], None] = lambda rows: None,
    ):
        self.packed, self.journal, self.executor = job.packed(), journal, executor
        self.command, self.report, self.total, self.tell = job.command, report, total, tell
        self.wanted: set[str] = set()
        self.pending: dict[Future[Rows], tuple[Item, ...]] = {}
        self.counts: Counter[Status] = Counter()
        self.fresh = 0
        self.start = self.synced = time.monotonic()

    def pace(self) -> Pace:
        """How far it is."""
        elapsed = time.monotonic() - self.start
        errors = self.counts[Status.ERROR]
        return Pace(self.total, self.counts.total(), self.fresh, errors, elapsed)

    def work(self, logs: Iterable[tuple[str, str]]) -> None:
        """Do all ``logs``, each the name of its row and its path."""
        for chunk in self._chunks(logs):
            if self.executor.worn:
                self._drain(0)
                self.executor.renew()
            self._drain(AHEAD * self.executor.workers - 1)
            self.pending[self._submit(chunk)] = chunk
        self._drain(0)

    def _submit(self, chunk: tuple[Item, ...]) -> Future[Rows]:
        """Hand over a chunk; a pool that broke a moment ago gives a future that has failed."""
        try:
            return self.executor.submit(self.packed, chunk)
        except BrokenExecutor as error:
            future: Future[Rows] = Future()
            future.set_exception(error)
            return future

    def _chunks(self, logs: Iterable[tuple[str, str]]) -> Iterator[tuple[Item, ...]]:
        """Small chunks first, so that few logs are spread over all workers."""
        chunk: list[Item] = []
        begun = 0
        for name, path in logs:
            if name in self.wanted:  # two patterns named it
                self.total -= 1
                continue
            self.wanted.add(name)
            chunk.append(Item(name, os.path.abspath(path), self._known(name)))
            if len(chunk) >= min(CHUNK[self.command], 1 + begun // (8 * self.executor.workers)):
                begun += len(chunk)
                yield tuple(chunk)
                chunk = []
        if chunk:
            yield tuple(chunk)

    def _known(self, name: str) -> str | None:
        """Digest of the row that a log has; one that was lost is done again."""
        row = self.journal.row(name)
        return None if row is None or row.lost else row.digest

    def _drain(self, most: int) -> None:
        """Wait until at most ``most`` chunks are under way, and keep what is finished."""
        while len(self.pending) > most:
            finished, _ = wait(self.pending, return_when=FIRST_COMPLETED)
            suspects = self._gather(finished)
            if suspects:
                self._alone(suspects)

    def _gather(self, finished: Iterable[Future[Rows]]) -> list[Item]:
        """Keep what came out of finished chunks; return the logs whose worker died."""
        suspects: list[Item] = []
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

    def _alone(self, suspects: list[Item]) -> None:
        """Do the logs of dead workers again, one at a time: the one that kills again is guilty."""
        # a pool that lost one worker loses all that was under way
        suspects += self._gather(wait(self.pending).done)
        self.executor.renew()
        for item in suspects:
            try:
                rows = self.executor.submit(self.packed, (item,)).result()
            except BrakeCalError:
                raise
            except Exception as error:
                said = f"{item.name}: the worker died on it twice ({type(error).__name__})"
                hint = "; is there enough memory? the next run tries it again"
                rows = [Row(item.name, None, Status.ERROR, said + hint, lost=True)]
                self.executor.renew()
            self._keep((item,), rows)

    def _keep(self, items: tuple[Item, ...], rows: Rows) -> None:
        """Journal the rows of a chunk; an unchanged log has its row there."""
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
        """A log that could not be read, and still cannot, has its row."""
        return row.digest is None and self.journal.row(row.log) == row

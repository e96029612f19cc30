"""Run a batch: find logs, skip finished ones, compute the others in chunks, write the results.

find ──> [a limited number of chunks] ──> workers ──> journal ──> results.parquet
                           └── if a worker died: its logs again, one at a time
"""

import glob
import math
import os
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, BrokenExecutor, Future, wait
from contextlib import closing
from dataclasses import dataclass
from datetime import timedelta
from pathlib import Path

from calib.base.errors import BrakeCalError, LogError
from calib.base.printable import printable
from calib.line.fleet.journal import BatchJournal
from calib.line.fleet.results import NAME, write_results
from calib.line.fleet.rows import Command, Row, Status
from calib.line.fleet.work import CALIBRATION, HOLDOUT, VEHICLE, Job, WorkItem
from calib.line.fleet.workers import Executor, Rows
from calib.logs.read import FORMATS

CHUNK = {Command.FIT: 2, Command.VALIDATE: 8, Command.CHECK: 8, Command.DIAGNOSE: 1}
"""Most logs in a chunk: so many that the transfer is negligible compared to 10 ms for each log."""

AHEAD = 3
"""Submitted chunks for each worker: one in progress and the others waiting."""


@dataclass(frozen=True)
class Pace:
    """``total`` logs, ``done`` in this run or before, ``fresh`` in this run, ``elapsed`` [s]."""

    total: int
    done: int
    fresh: int
    errors: int
    elapsed: float

    @property
    def rate(self) -> float:
        """Logs per second of this run; 0 before the first."""
        return self.fresh / self.elapsed if self.elapsed > 0.0 else 0.0

    def __str__(self) -> str:
        """The progress in words.

        >>> str(Pace(total=300, done=200, fresh=100, errors=2, elapsed=0.5))
        '200 of 300 logs, 200 a second, 0:00:01 left, 2 with errors'
        """
        text = f"{self.done} of {self.total} logs"
        if self.rate > 0.0:
            text += f", {self.rate:.3g} a second"
            if self.done < self.total:
                left = math.ceil((self.total - self.done) / self.rate)
                text += f", {timedelta(seconds=left)} left"
        return text + (f", {self.errors} with errors" if self.errors else "")


@dataclass(frozen=True)
class Batch:
    """Result of a run: ``counts`` of rows by status, path of the results, and speed."""

    results: Path
    counts: Counter[Status]
    pace: Pace

    @property
    def unreadable(self) -> bool:
        """Whether no log has a result."""
        return self.counts[Status.ERROR] == self.counts.total()

    @property
    def failed(self) -> bool:
        """Whether a log fails its limits."""
        return self.counts[Status.FAILED] > 0

    def document(self) -> dict[str, object]:
        """The counts, and data on this run, as plain data."""
        return {
            "schema": 1,
            "results": self.results,
            "logs": self.counts.total(),
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
    report: Callable[[Pace], None] = lambda pace: None,
    fresh: bool = False,
) -> Batch:
    """Run the job on every log that ``arguments`` name and write ``out``/results.parquet.

    Continues an earlier run with the same settings; ``fresh`` starts again. A log that fails gets a
    row. Raises LogError when an argument names no log, BatchError when ``out`` holds
    another batch or the workers are not of this version, OSError when ``out`` cannot be written.
    """
    logs = {printable(path): path for path in find_logs(arguments, job.command, out)}
    out.mkdir(parents=True, exist_ok=True)
    settings = job.settings()
    with closing(BatchJournal(out, settings, fresh)) as journal:
        sweep = Sweep(job, journal, executor, len(logs), report)
        sweep.work(logs.items())
        path = write_results(journal.rows(sorted(logs)), settings, out)
        return Batch(path, sweep.counts, sweep.pace())


class Sweep:
    """Submits ``total`` logs to the workers, and writes their rows into the journal.

    ``report`` is called with the pace after each chunk, ``tell`` with each of its new rows.
    """

    def __init__(
        self,
        job: Job,
        journal: BatchJournal,
        executor: Executor,
        total: int,
        report: Callable[[Pace], None] = lambda pace: None,
        tell: Callable[[Row], None] = lambda row: None,
    ):
        self.packed, self.journal, self.executor = job.packed(), journal, executor
        self.most, self.total, self.report, self.tell = CHUNK[job.command], total, report, tell
        self.pending: dict[Future[Rows], tuple[WorkItem, ...]] = {}
        self.counts: Counter[Status] = Counter()
        self.fresh = 0
        self.start = time.monotonic()

    def pace(self) -> Pace:
        """So far."""
        elapsed = time.monotonic() - self.start
        errors = self.counts[Status.ERROR]
        return Pace(self.total, self.counts.total(), self.fresh, errors, elapsed)

    def work(self, logs: Iterable[tuple[str, str]]) -> None:
        """Compute all ``logs``, each as (name of its row, path)."""
        for chunk in self._chunks(logs):
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
            row = self.journal.row(name)
            known = None if row is None or row.lost else row.digest
            chunk.append(WorkItem(name, os.path.abspath(path), known))
            if len(chunk) >= min(self.most, 1 + begun // (8 * self.executor.workers)):
                begun += len(chunk)
                yield tuple(chunk)
                chunk = []
        if chunk:
            yield tuple(chunk)

    def _drain(self, most: int) -> None:
        """Wait until at most ``most`` chunks are unfinished, and store finished rows."""
        while len(self.pending) > most:
            suspects = self._gather(wait(self.pending, return_when=FIRST_COMPLETED).done)
            if suspects:
                # a pool that lost one worker loses all unfinished logs
                suspects += self._gather(wait(self.pending).done)
                self.executor.renew()
                for item in suspects:
                    self._keep((item,), self._alone(item))

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

    def _alone(self, item: WorkItem) -> Rows:
        """Repeat the log of a dead worker; an error for one that kills again."""
        try:
            return self.executor.submit(self.packed, (item,)).result()
        except BrakeCalError:
            raise
        except Exception as error:
            self.executor.renew()
            text = f"{item.name}: the worker died on it twice ({type(error).__name__})"
            hint = "; is there enough memory? the next run tries it again"
            return [Row(item.name, None, Status.ERROR, text + hint, lost=True)]

    def _keep(self, items: tuple[WorkItem, ...], rows: Rows) -> None:
        """Store the rows of a chunk; an unchanged log already has its row in the journal."""
        computed = [row for row in rows if row is not None]
        # a log that cannot be read has no digest: it is tried each time
        new = [r for r in computed if r.digest is not None or self.journal.row(r.log) != r]
        self.journal.add(new)
        self.fresh += len(computed)
        stored = (item.name for item, row in zip(items, rows, strict=True) if row is None)
        self.counts.update(row.status for row in (*computed, *self.journal.rows(stored)))
        self.report(self.pace())
        for row in new:
            self.tell(row)


def find_logs(arguments: Iterable[str], command: Command, out: Path) -> Iterator[str]:
    """Paths of the logs, relative where the argument is; one may come twice.

    A folder means all logs in it and below. For DIAGNOSE a log is a folder with calibration/,
    holdout/ and vehicle.toml. Hidden files and the results in ``out`` are left out; if ``out`` is a
    folder within an argument, so is all its content. Raises LogError for a pattern or folder
    without logs, and for a missing path; a missing file with the ending of a log is returned.
    """
    folders = command == Command.DIAGNOSE
    for argument in arguments:
        found = list(_of(argument, command, out))
        if not found:
            wanted = f"folders with {CALIBRATION}/, {HOLDOUT}/ and {VEHICLE}"
            raise LogError(
                "no log found",
                where=argument,
                expected=wanted if folders else f"files that end in {', '.join(FORMATS)}",
                do="check the path; put a pattern in quotes",
            )
        yield from found


def _of(argument: str, command: Command, out: Path) -> Iterator[str]:
    if os.path.isdir(argument):
        yield from logs_below(argument, command, out)
    elif os.path.exists(argument) or (_is_log(argument) and not glob.has_magic(argument)):
        yield argument  # a missing file gets a row with an error
    else:
        results = os.path.realpath(out / NAME)
        for path in sorted(glob.iglob(argument, recursive=True)):
            if os.path.isdir(path):
                yield from logs_below(path, command, out)
            elif command != Command.DIAGNOSE and _is_log(path):
                yield from () if os.path.realpath(path) == results else (path,)


def _refuse(error: OSError) -> None:
    raise LogError(f"cannot be read ({error.strerror})", where=error.filename) from error


def logs_below(
    folder: str, command: Command, out: Path, trouble: Callable[[OSError], None] = _refuse
) -> Iterator[str]:
    """Paths of the logs in a folder and below, possibly none. Else like `find_logs`.

    ``trouble`` is called with the error if a folder cannot be read; the folder is then skipped.
    """
    own = os.path.realpath(out)
    for home, folders, files in os.walk(folder, onerror=trouble):
        folders[:] = sorted(f for f in folders if not f.startswith("."))
        here = os.path.realpath(home) == own
        if here and home != folder:
            folders.clear()
        elif command == Command.DIAGNOSE:
            if VEHICLE in files and {CALIBRATION, HOLDOUT} <= set(folders):
                folders.clear()
                yield home
        else:
            logs = (f for f in sorted(files) if _is_log(f) and not (here and f == NAME))
            yield from (os.path.join(home, f) for f in logs)


def _is_log(path: str) -> bool:
    name = os.path.basename(path)
    return name.lower().endswith(FORMATS) and not name.startswith(".")

"""Watch a folder for new logs: each is processed once, when it is complete.

look ──> settled ──> workers ──> journal, on the disk ──> report
  └── every second when all are done; writes results.parquet then, and regularly before
"""

import math
import os
import stat
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field
from pathlib import Path
from threading import Event

from calib.base.printable import printable
from calib.line.fleet.columns import Status
from calib.line.fleet.command import Command
from calib.line.fleet.find import logs_below
from calib.line.fleet.job import Job
from calib.line.fleet.journal import BatchJournal, open_journal
from calib.line.fleet.pool import Executor
from calib.line.fleet.results import NAME as RESULTS
from calib.line.fleet.results import write_results
from calib.line.fleet.row import Row
from calib.line.fleet.run import Sweep

RETRY = 60.0
"""Time after which a log that could not be read, or killed its worker, is tried again [s]."""
LATE = 30.0
"""Longest delay of the results file behind the journal while logs arrive [s]."""

Stamp = tuple[int, int, int]
"""Size [B], modification time and inode change time [ns] of a file."""


@dataclass
class Settled:
    """Files that are complete: size and times of change are constant for ``settle`` [s]."""

    settle: float
    _since: dict[str, tuple[Stamp, float]] = field(default_factory=dict)
    _given: dict[str, tuple[Stamp, float]] = field(default_factory=dict)

    def look(self, paths: Iterable[str], now: float) -> list[str]:
        """Those of ``paths`` that are complete and new or changed; ``now`` [s]."""
        since: dict[str, tuple[Stamp, float]] = {}
        for path in paths:
            stamp = _stamp(path)
            if stamp is not None:
                before, start = self._since.get(path, (stamp, now))
                since[path] = stamp, start if before == stamp else now
        self._since = since
        self._given = {path: given for path, given in self._given.items() if path in since}
        return [path for path in since if self._ready(path, now)]

    def give(self, path: str, again: float = math.inf) -> None:
        """Mark a file as given to a worker; it is ready again at ``again`` [s]."""
        self._given[path] = self._since[path][0], again

    def _ready(self, path: str, now: float) -> bool:
        stamp, start = self._since[path]
        given, again = self._given.get(path, (None, math.inf))
        return now - start >= self.settle and (given != stamp or now >= again)


def _stamp(path: str) -> Stamp | None:
    """Stamp of a file; None if it is gone or not a regular file."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    if not stat.S_ISREG(found.st_mode):
        return None
    return found.st_size, found.st_mtime_ns, found.st_ctime_ns


@dataclass(frozen=True)
class Watched:
    """Result of a watch: number of logs by status, and path of the results; None without logs."""

    results: Path | None
    counts: Counter[Status]


def watch(
    job: Job,
    folder: Path,
    out: Path,
    executor: Executor,
    stop: Event,
    tell: Callable[[Row], None] = lambda row: None,
    trouble: Callable[[str], None] = lambda text: None,
    *,
    every: float = 1.0,
    settle: float = 2.0,
    fresh: bool = False,
    each: Callable[[], None] = lambda: None,
    clock: Callable[[], float] = time.monotonic,
) -> Watched:
    """Run the job on every log that appears in ``folder`` or below, until ``stop`` is set.

    Parameters
    ----------
    job : the job; "diagnose" is refused, because its logs are folders without a sign of completion.
    folder, out : where logs appear; where journal and results.parquet are kept, as in `run_batch`.
        Rows are named by their path within ``folder``.
    executor : workers.
    tell : called with the row of each log, after it is in the journal and on the disk. After a
        crash before the call, the row is not reported later.
    trouble : called once when a folder cannot be read, and again only after it was readable.
    every, settle : time between two scans [s]; time for which a file must not change [s].
    fresh : delete earlier results in ``out``.
    each : called after each scan of the folder.
    clock : monotonic time [s].

    A log is repeated only if its digest has changed, so a watch that was stopped or killed
    continues. A log that was deleted keeps its row. Raises BatchError like `run_batch` and when
    ``out`` belongs to another folder, OSError when it cannot be written.
    """
    if job.command == Command.DIAGNOSE:
        raise ValueError("a folder of logs has no sign that it is complete")
    out.mkdir(parents=True, exist_ok=True)
    settings = {**job.settings(), "folder": printable(os.path.realpath(folder))}
    journal = open_journal(out, settings, fresh)
    try:
        settled = Settled(settle)
        over = _Watch(job, folder, out, executor, stop, tell, journal, settings, settled, clock)
        troubled: set[str] = set()
        while not stop.is_set():
            ready, found = over.look()
            for where in sorted(found.keys() - troubled):
                trouble(f"{where}: cannot be read ({found[where]})")
            troubled = set(found)
            each()
            if ready:
                over.do(ready)
            else:
                over.write()
                stop.wait(every)
        return Watched(over.write(), journal.counts())
    finally:
        journal.close()


@dataclass
class _Watch:
    """State of a running watch."""

    job: Job
    folder: Path
    out: Path
    executor: Executor
    stop: Event
    tell: Callable[[Row], None]
    journal: BatchJournal
    settings: dict[str, str]
    settled: Settled
    clock: Callable[[], float]
    behind: bool = True
    written: float = -math.inf

    def look(self) -> tuple[list[str], dict[str, str]]:
        """The logs that are ready, and the errors of folders that could not be read."""
        trouble: dict[str, str] = {}

        def note(error: OSError) -> None:
            trouble[printable(str(error.filename))] = str(error.strerror)

        paths = logs_below(str(self.folder), self.job.command, self.out, note)
        return self.settled.look(paths, self.clock()), trouble

    def do(self, paths: list[str]) -> None:
        """Compute some logs; after ``stop`` only those already submitted."""
        logs = {printable(os.path.relpath(path, self.folder)): path for path in paths}
        sweep = Sweep(
            self.job, self.journal, self.executor, lambda pace: None, len(logs), self._report
        )
        sweep.work(self._until_stopped(logs))
        for row in self.journal.rows(sweep.wanted):
            if row.digest is None or row.lost:
                self.settled.give(logs[row.log], self.clock() + RETRY)

    def _until_stopped(self, logs: dict[str, str]) -> Iterator[tuple[str, str]]:
        for name, path in logs.items():
            if self.stop.is_set():
                return
            self.settled.give(path)
            yield name, path

    def _report(self, rows: list[Row]) -> None:
        self.behind = True
        self.journal.sync()
        for row in rows:
            self.tell(row)
        if self.clock() - self.written > LATE:
            self.write()

    def write(self) -> Path | None:
        """Write the results of all logs so far, if some are new."""
        logs = self.journal.logs()
        if not logs:
            return None
        if self.behind:
            write_results(self.journal.rows(logs), self.settings, self.out)
            self.behind, self.written = False, self.clock()
        return self.out / RESULTS

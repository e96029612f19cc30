"""A folder that a bench drops logs into: each is done once, when it is written no more.

look ──> settled ──> workers ──> journal, on the disk ──> told
  └── every second when all are done; results.parquet then, and now and then on the way
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

from calib.files import printable
from calib.fleet.columns import Status
from calib.fleet.command import Command
from calib.fleet.find import logs_below
from calib.fleet.job import Job
from calib.fleet.journal import Journal, open_journal
from calib.fleet.pool import Executor
from calib.fleet.results import NAME as RESULTS
from calib.fleet.results import write_results
from calib.fleet.row import Row
from calib.fleet.run import Sweep

RETRY = 60.0
"""Seconds after which a log is tried again that could not be read, or killed its worker."""
LATE = 30.0
"""Seconds for which the results may be behind the journal while logs keep coming."""

Stamp = tuple[int, int, int]
"""Size [B], time of change and time of change of the entry [ns] of a file."""


@dataclass
class Settled:
    """Which files are written no more: size and times of change stay for ``settle`` seconds."""

    settle: float
    _since: dict[str, tuple[Stamp, float]] = field(default_factory=dict)
    _given: dict[str, tuple[Stamp, float]] = field(default_factory=dict)

    def look(self, paths: Iterable[str], now: float) -> list[str]:
        """Those of ``paths`` that are ready and were not given before as they are; ``now`` [s]."""
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
        """Take note that a file is being done; it is ready once more at ``again`` [s]."""
        self._given[path] = self._since[path][0], again

    def _ready(self, path: str, now: float) -> bool:
        stamp, start = self._since[path]
        given, again = self._given.get(path, (None, math.inf))
        return now - start >= self.settle and (given != stamp or now >= again)


def _stamp(path: str) -> Stamp | None:
    """None for what was taken away a moment ago and for what is no regular file."""
    try:
        found = os.stat(path)
    except OSError:
        return None
    if not stat.S_ISREG(found.st_mode):
        return None
    return found.st_size, found.st_mtime_ns, found.st_ctime_ns


@dataclass(frozen=True)
class Watched:
    """How a watch ended: logs by status, and the results; None where there never was a log."""

    results: Path | None
    counts: Counter[Status]


def watch(
    job: Job,
    folder: Path,
    out: Path,
    executor: Executor,
    stop: Event,
    tell: Callable[[Row], None] = lambda row: None,
    trouble: Callable[[str], None] = lambda said: None,
    *,
    every: float = 1.0,
    settle: float = 2.0,
    fresh: bool = False,
    clock: Callable[[], float] = time.monotonic,
) -> Watched:
    """Do every log that appears in ``folder`` or below, until ``stop`` is set.

    Parameters
    ----------
    job : what to do; "diagnose" has no files that are whole by themselves and is refused.
    folder, out : where logs appear; where journal and results.parquet are kept, as in `run_batch`.
        Rows are named by their path within ``folder``.
    executor : workers.
    tell : called with the row of each log, once it is in the journal and on the disk: a row whose
        telling a crash prevents is not told later.
    trouble : called when a folder cannot be read, once until it can be again.
    every, settle : seconds between two looks; seconds for which a file must not change.
    fresh : throw away what ``out`` holds.
    clock : monotonic time [s].

    A log with the digest of its row is not done again, so a watch that was stopped or killed goes
    on where it was; one that changes is done again. A log that was taken away keeps its row.
    Raises BatchError as `run_batch` and when ``out`` belongs to another folder, OSError when it
    cannot be written.
    """
    if job.command == Command.DIAGNOSE:
        raise ValueError("a folder of a car's logs does not say when it is whole")
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
    """A watch at work."""

    job: Job
    folder: Path
    out: Path
    executor: Executor
    stop: Event
    tell: Callable[[Row], None]
    journal: Journal
    settings: dict[str, str]
    settled: Settled
    clock: Callable[[], float]
    behind: bool = True
    written: float = -math.inf

    def look(self) -> tuple[list[str], dict[str, str]]:
        """The logs that are ready, and why folders could not be read."""
        trouble: dict[str, str] = {}

        def note(error: OSError) -> None:
            trouble[printable(str(error.filename))] = str(error.strerror)

        paths = logs_below(str(self.folder), self.job.command, self.out, note)
        return self.settled.look(paths, self.clock()), trouble

    def do(self, paths: list[str]) -> None:
        """Do some logs, or as many as are under way when the watch is to stop."""
        logs = {printable(os.path.relpath(path, self.folder)): path for path in paths}
        sweep = Sweep(
            self.job, self.journal, self.executor, lambda pace: None, len(logs), self._told
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

    def _told(self, rows: list[Row]) -> None:
        self.behind = True
        self.journal.sync()
        for row in rows:
            self.tell(row)
        if self.clock() - self.written > LATE:
            self.write()

    def write(self) -> Path | None:
        """Write the results of all logs so far, if there are any and some are new."""
        logs = self.journal.logs()
        if not logs:
            return None
        if self.behind:
            write_results(self.journal.rows(logs), self.settings, self.out)
            self.behind, self.written = False, self.clock()
        return self.out / RESULTS

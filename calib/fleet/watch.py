"""A folder that a bench drops logs into: each is done once, when it is written no more.

look ──> settled ──> a few at a time ──> journal ──> told
  └── every second, and at once while some are left; then results.parquet
"""

import os
import time
from collections import Counter
from collections.abc import Callable, Iterable
from dataclasses import dataclass, field
from pathlib import Path
from threading import Event

from calib.errors import LogError
from calib.files import printable
from calib.fleet.find import logs_below
from calib.fleet.job import Job
from calib.fleet.journal import Journal, open_journal
from calib.fleet.pool import Executor
from calib.fleet.results import write_results
from calib.fleet.row import Row
from calib.fleet.run import AHEAD, Run

Stamp = tuple[int, int]
"""Size [B] and time of change [ns] of a file."""


@dataclass
class Settled:
    """Which files are written no more: size and time of change stay for ``settle`` seconds."""

    settle: float
    _since: dict[str, tuple[Stamp, float]] = field(default_factory=dict)
    _given: dict[str, Stamp] = field(default_factory=dict)

    def look(self, paths: Iterable[str], now: float) -> list[str]:
        """Those of ``paths`` that are ready and were not given before as they are; ``now`` [s]."""
        since: dict[str, tuple[Stamp, float]] = {}
        ready = []
        for path in paths:
            stamp = _stamp(path)
            if stamp is None:  # taken away a moment ago
                continue
            before, start = self._since.get(path, (stamp, now))
            since[path] = stamp, start if before == stamp else now
            if now - since[path][1] >= self.settle and self._given.get(path) != stamp:
                ready.append(path)
        self._since = since
        return ready

    def give(self, path: str) -> None:
        """Take note that a file is being done."""
        self._given[path] = self._since[path][0]


def _stamp(path: str) -> Stamp | None:
    try:
        found = os.stat(path)
    except OSError:
        return None
    return found.st_size, found.st_mtime_ns


@dataclass(frozen=True)
class Watched:
    """How a watch ended: logs by status, and the results; None where there never was a log."""

    results: Path | None
    counts: dict[str, int]


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
    clock: Callable[[], float] = time.monotonic,
) -> Watched:
    """Do every log that appears in ``folder`` or below, until ``stop`` is set.

    Parameters
    ----------
    job : what to do; "diagnose" has no files that are whole by themselves and is refused.
    folder, out : where logs appear; where journal and results.parquet are kept, as in `run_batch`.
    executor : workers.
    tell : called with the row of each log.
    trouble : called when the folder cannot be read, once until it can be again.
    every, settle : seconds between two looks; seconds for which a file must not change.
    clock : monotonic time [s].

    A log with the digest of its row is not done again, so a watch that was stopped or killed goes
    on where it was; one that changes is done again. A log that was taken away keeps its row.
    Raises BatchError as `run_batch`, OSError when ``out`` cannot be written.
    """
    if job.command == "diagnose":
        raise ValueError("a folder of a car's logs does not say when it is whole")
    out.mkdir(parents=True, exist_ok=True)
    journal = open_journal(out, job.settings())
    settled, behind, lost = Settled(settle), True, False
    try:
        while not stop.is_set():
            try:
                ready = settled.look(logs_below(str(folder), job.command, out), clock())
                lost = False
            except LogError as error:
                ready = []
                if not lost:
                    trouble(str(error))
                lost = True
            if ready:
                behind = True
                portion = ready[: AHEAD * executor.workers]
                for path in portion:
                    settled.give(path)
                for row in _done(job, journal, executor, portion):
                    tell(row)
            else:
                behind = behind and not _write(job, journal, out)
                stop.wait(every)
        journal.sync()
        counts = Counter(entry.status for entry in journal.entries.values())
        return Watched(_write(job, journal, out), dict(sorted(counts.items())))
    finally:
        journal.close()


def _done(job: Job, journal: Journal, executor: Executor, paths: list[str]) -> list[Row]:
    """Do some logs; the rows of those that are new or changed."""
    names = [printable(path) for path in paths]
    before = [journal.entries.get(name) for name in names]
    Run(job, journal, executor, lambda pace: None, len(paths)).work(iter(paths))
    new = [n for n, old in zip(names, before, strict=True) if journal.entries[n] is not old]
    return list(journal.rows(new))


def _write(job: Job, journal: Journal, out: Path) -> Path | None:
    """Write the results of all logs so far, if there are any."""
    if not journal.entries:
        return None
    return write_results(journal.rows(sorted(journal.entries)), job.settings(), out)

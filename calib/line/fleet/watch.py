"""Watch a folder for new logs: each is processed once, when it is complete.

look ──> settled ──> workers ──> journal, on the disk ──> told
  └── every second when all are done; writes results.parquet then, and regularly before
"""

import math
import os
import stat
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from contextlib import closing
from pathlib import Path
from threading import Event

from calib.base.errors import printable
from calib.line.fleet.batch import Sweep, logs_below
from calib.line.fleet.journal import BatchJournal
from calib.line.fleet.results import write_results
from calib.line.fleet.rows import Row, Status
from calib.line.fleet.work import Job
from calib.line.fleet.workers import Executor

_RETRY = 60.0
"""Time after which a log that could not be read, or killed its worker, is tried again [s]."""
_LATE = 30.0
"""Longest delay of the results file behind the journal while logs arrive [s]."""


class _Settled:
    """Files that are complete: size and times of change are constant for ``settle`` [s]."""

    def __init__(self, settle: float):
        self.settle = settle
        self._files: dict[str, tuple[tuple[int, ...], float]] = {}
        """Size and times of each file, and when it is ready [s]."""

    def look(self, paths: Iterable[str], now: float) -> list[str]:
        """Those of ``paths`` that are complete and new or changed; ``now`` [s]."""
        earlier, self._files = self._files, {}
        for path in paths:
            if stamp := _stamp(path):
                old = earlier.get(path)
                self._files[path] = old if old and old[0] == stamp else (stamp, now + self.settle)
        return [path for path, (_, ready) in self._files.items() if now >= ready]

    def give(self, path: str, again: float = math.inf) -> None:
        """Mark a file as given to a worker; it is ready again at ``again`` [s]."""
        self._files[path] = self._files[path][0], again


def _stamp(path: str) -> tuple[int, ...] | None:
    """Size and times of change of a file; None if it is gone or not a regular one."""
    try:
        status = os.stat(path)
    except OSError:
        return None
    stamp = status.st_size, status.st_mtime_ns, status.st_ctime_ns
    return stamp if stat.S_ISREG(status.st_mode) else None


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
    clock: Callable[[], float] = time.monotonic,
) -> Counter[Status]:
    """Run the job on every log that appears in ``folder`` or below, until ``stop`` is set.

    ``folder`` is scanned each ``every`` [s], a log is complete after ``settle`` [s] without change;
    ``out`` keeps journal and results.parquet as in `run_batch`, rows named by their path within
    ``folder``. ``tell`` is called with each row after it is on the disk, ``trouble`` once when a
    folder cannot be read; ``clock`` [s]. Returns the number of rows by status.

    A log is repeated only if its digest has changed; one that was deleted keeps its row. The job is
    not "diagnose": its logs are folders without a sign of completion. Raises like `run_batch`.
    """
    settings = {**job.settings(), "folder": printable(os.path.realpath(folder))}
    files, troubled, written, behind = _Settled(settle), set[str](), -math.inf, True

    def until_stopped(logs: dict[str, str]) -> Iterator[tuple[str, str]]:
        for name, path in logs.items():
            if stop.is_set():
                return
            files.give(path)
            yield name, path

    with closing(BatchJournal(out, settings)) as journal:
        while not stop.is_set():
            errors: list[OSError] = []
            paths = logs_below(str(folder), job.command, out, errors.append)
            ready = files.look(paths, clock())
            unreadable = {
                f"{printable(str(e.filename))}: cannot be read ({e.strerror})" for e in errors
            }
            for text in sorted(unreadable - troubled):
                trouble(text)
            troubled = unreadable
            logs = {printable(os.path.relpath(path, folder)): path for path in ready}
            sweep = Sweep(job, journal, executor, len(logs), tell=tell)
            sweep.work(until_stopped(logs))
            for row in journal.rows(logs):
                if row.digest is None or row.lost:
                    files.give(logs[row.log], clock() + _RETRY)
            behind = behind or bool(ready)
            if behind and (not ready or stop.is_set() or clock() - written > _LATE):
                names = journal.logs()
                if names:
                    write_results(journal.rows(names), settings, out)
                behind, written = False, clock()
            if not ready:
                stop.wait(every)
        return journal.counts()

"""Watch a folder for new logs. Each log is processed once, when its file is complete.

scan ──> complete files ──> workers ──> journal, on the disk ──> on_row

The folder is scanned again when all complete files are processed, every second if there are none.
results.parquet is written when no complete file is left, and every 30 s while logs arrive.
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
from calib.line.fleet.batch import BatchRun, logs_below
from calib.line.fleet.journal import BatchJournal
from calib.line.fleet.results import write_results
from calib.line.fleet.rows import Row, Status
from calib.line.fleet.work import Job
from calib.line.fleet.workers import Executor

_PERIOD = 1.0  # time between two scans of a folder without complete files [s]
_RETRY = 60.0  # time until a log that could not be read or killed its worker is tried again [s]
_MAX_DELAY = 30.0  # longest delay of the results file behind the journal while logs arrive [s]


class _CompleteFiles:
    """Files, each complete when its size and times of change were constant for ``settle`` [s]."""

    def __init__(self, settle: float):
        self.settle = settle
        # `_stamp` of each file, and the time at which the file is ready [s]
        self._files: dict[str, tuple[tuple[int, ...], float]] = {}

    def ready(self, paths: Iterable[str], now: float) -> list[str]:
        """Return those of ``paths`` that are complete at the time ``now`` [s]."""
        earlier, self._files = self._files, {}
        for path in paths:
            stamp = _stamp(path)
            if path in earlier and earlier[path][0] == stamp:
                self._files[path] = earlier[path]
            elif stamp is not None:
                self._files[path] = stamp, now + self.settle
        return [path for path, (_, ready_at) in self._files.items() if now >= ready_at]

    def postpone(self, path: str, retry_at: float = math.inf) -> None:
        """Make an unchanged file ready again at ``retry_at`` [s], by default never."""
        self._files[path] = self._files[path][0], retry_at


def _stamp(path: str) -> tuple[int, ...] | None:
    """Return size and times of change of a file; None if it is gone or not a regular file."""
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
    on_row: Callable[[Row], None],
    on_error: Callable[[str], None],
    *,
    settle: float = 2.0,
    clock: Callable[[], float] = time.monotonic,
) -> Counter[Status]:
    """Run the job on every log that appears in ``folder`` or below, until ``stop`` is set.

    A log is complete after ``settle`` [s] without change. It is repeated only if its digest
    changes, and its row stays if the log is deleted. Names of logs are paths within ``folder``.
    ``on_row`` is called with each row on the disk, ``on_error`` once with each folder that cannot
    be read. Returns the number of rows by status. ``out`` and errors are as in `run_batch`.
    """
    settings = {**job.settings(), "folder": printable(os.path.realpath(folder))}
    files, reported = _CompleteFiles(settle), set[str]()
    written_at, is_outdated = -math.inf, True  # of results.parquet
    with closing(BatchJournal(out, settings)) as journal:
        while not stop.is_set():
            errors: list[OSError] = []
            paths = list(logs_below(str(folder), out, errors.append))
            flaws = {f"{printable(str(e.filename))}: cannot be read ({e.strerror})" for e in errors}
            for flaw in sorted(flaws - reported):
                on_error(flaw)
            reported = flaws
            ready = files.ready(paths, clock())
            logs = {printable(os.path.relpath(path, folder)): path for path in ready}
            run = BatchRun(job, journal, executor, len(logs), on_row=on_row)
            run.work(_started(logs, files, stop))
            for row in journal.rows(logs):
                if row.digest is None or row.lost:
                    files.postpone(logs[row.log], clock() + _RETRY)
            is_outdated = is_outdated or bool(ready)
            is_idle = not ready or stop.is_set()
            if is_outdated and (is_idle or clock() - written_at > _MAX_DELAY):
                all_names = journal.logs()
                if all_names:
                    write_results(journal.rows(all_names), settings, out)
                is_outdated, written_at = False, clock()
            if not ready:
                stop.wait(_PERIOD)
        return journal.counts()


def _started(logs: dict[str, str], files: _CompleteFiles, stop: Event) -> Iterator[tuple[str, str]]:
    """Yield name and path of each log until ``stop`` is set."""
    for name, path in logs.items():
        if stop.is_set():
            return
        files.postpone(path)  # the file is not ready again until it changes
        yield name, path

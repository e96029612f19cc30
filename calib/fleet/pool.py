"""Worker processes of this machine, as an executor that can be renewed when a worker was killed."""

import multiprocessing
import os
import signal
import threading
from concurrent.futures import Future, ProcessPoolExecutor
from typing import Protocol

from calib.fleet.row import Row
from calib.fleet.work import Item, run_items

Rows = list[Row | None]

LIFETIME = 20_000
"""Logs after which the workers are replaced: what a library leaks cannot add up over a fleet."""


def cores() -> int:
    """Cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Executor(Protocol):
    """Where logs are done: this machine or a cluster. A future that fails lost its worker."""

    @property
    def workers(self) -> int:
        """Logs that are done at a time."""

    @property
    def worn(self) -> bool:
        """Whether it should be renewed at the next pause."""

    def submit(self, packed: bytes, items: tuple[Item, ...]) -> "Future[Rows]":
        """Do some logs, see `calib.fleet.work.run_items`."""

    def renew(self) -> None:
        """Have fresh workers. Nothing is under way when it is called, or all of it is lost."""

    def close(self) -> None:
        """Let the workers go; what is under way is dropped."""


class Pool:
    """``workers`` processes, each with one thread of linear algebra."""

    def __init__(self, workers: int):
        self._workers, self._given = workers, 0
        for library in ("OPENBLAS", "OMP", "MKL"):
            os.environ.setdefault(f"{library}_NUM_THREADS", "1")
        self._pool = self._new()

    @property
    def workers(self) -> int:
        """Processes."""
        return self._workers

    @property
    def worn(self) -> bool:
        """Whether the workers have done enough."""
        return self._given >= LIFETIME * self._workers

    def submit(self, packed: bytes, items: tuple[Item, ...]) -> "Future[Rows]":
        """Hand logs to the next free worker."""
        self._given += len(items)
        return self._pool.submit(run_items, packed, items)

    def renew(self) -> None:
        """End the workers and start others."""
        self._pool.shutdown(wait=True, cancel_futures=True)
        self._pool, self._given = self._new(), 0

    def close(self) -> None:
        """End the workers, in the middle of a log if need be: it has no row and is done again."""
        for process in list((self._pool._processes or {}).values()):
            process.terminate()
        self._pool.shutdown(wait=True, cancel_futures=True)

    def _new(self) -> ProcessPoolExecutor:
        return ProcessPoolExecutor(self._workers, _context(), initializer=_start)


def _context() -> multiprocessing.context.BaseContext:
    """Workers forked off a small server that has imported once; fresh interpreters elsewhere."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["calib.fleet.warm"])
    return context


def _start() -> None:
    """Begin a worker: the parent alone hears an interrupt, and nobody outlives the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)

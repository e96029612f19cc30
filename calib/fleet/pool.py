"""Worker processes of this machine as an `Executor` that can be renewed after a worker died."""

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
"""Number of logs after which the workers are replaced, because libraries may leak memory."""


def cores() -> int:
    """Number of cores that this process may use."""
    if hasattr(os, "sched_getaffinity"):
        return len(os.sched_getaffinity(0))
    return os.cpu_count() or 1


class Executor(Protocol):
    """Computes rows on this machine or a cluster. A future fails if its worker died."""

    @property
    def workers(self) -> int:
        """Number of logs at a time."""

    @property
    def worn(self) -> bool:
        """Whether it should be renewed at the next pause."""

    def submit(self, packed: bytes, items: tuple[Item, ...]) -> "Future[Rows]":
        """Compute the rows of some logs, see `calib.fleet.work.run_items`."""

    def renew(self) -> None:
        """Replace the workers. Unfinished logs are lost."""

    def close(self) -> None:
        """Release the workers; unfinished logs are dropped."""


class Pool:
    """``workers`` processes, each with one thread for linear algebra."""

    def __init__(self, workers: int):
        self._workers, self._given = workers, 0
        for library in ("OPENBLAS", "OMP", "MKL"):
            os.environ.setdefault(f"{library}_NUM_THREADS", "1")
        self._pool = self._new()

    @property
    def workers(self) -> int:
        """Number of processes."""
        return self._workers

    @property
    def worn(self) -> bool:
        """Whether the workers should be replaced."""
        return self._given >= LIFETIME * self._workers

    def submit(self, packed: bytes, items: tuple[Item, ...]) -> "Future[Rows]":
        """Submit logs to the next free worker."""
        self._given += len(items)
        return self._pool.submit(run_items, packed, items)

    def renew(self) -> None:
        """End the workers and start others."""
        self._pool.shutdown(wait=True, cancel_futures=True)
        self._pool, self._given = self._new(), 0

    def close(self) -> None:
        """End the workers, also during a log; it has no row and the next run repeats it."""
        for process in list((self._pool._processes or {}).values()):
            process.terminate()
        self._pool.shutdown(wait=True, cancel_futures=True)

    def _new(self) -> ProcessPoolExecutor:
        return ProcessPoolExecutor(self._workers, _context(), initializer=_start)


def _context() -> multiprocessing.context.BaseContext:
    """Fork workers from a server that has imported the library; spawn them on other systems."""
    if "forkserver" not in multiprocessing.get_all_start_methods():
        return multiprocessing.get_context("spawn")
    context = multiprocessing.get_context("forkserver")
    context.set_forkserver_preload(["calib.fleet.warm"])
    return context


def _start() -> None:
    """Start a worker: it ignores interrupts, which the parent handles, and ends with the parent."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)

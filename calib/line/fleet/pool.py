"""Worker processes of this machine as an `Executor` that can be renewed after a worker died."""

from concurrent.futures import Future, ProcessPoolExecutor
from typing import Protocol

from calib.base.processes import end, workers
from calib.line.fleet.row import Row
from calib.line.fleet.work import WorkItem, run_items

Rows = list[Row | None]

LIFETIME = 20_000
"""Number of logs after which the workers are replaced, because libraries may leak memory."""


class Executor(Protocol):
    """Computes rows on this machine or a cluster. A future fails if its worker died."""

    @property
    def workers(self) -> int:
        """Number of logs at a time."""

    @property
    def worn(self) -> bool:
        """Whether it should be renewed at the next pause."""

    def submit(self, packed: bytes, items: tuple[WorkItem, ...]) -> "Future[Rows]":
        """Compute the rows of some logs, see `calib.line.fleet.work.run_items`."""

    def renew(self) -> None:
        """Replace the workers. Unfinished logs are lost."""

    def close(self) -> None:
        """Release the workers; unfinished logs are dropped."""


class Pool:
    """``count`` worker processes."""

    def __init__(self, count: int):
        self._workers, self._given = count, 0
        self._pool = self._new()

    @property
    def workers(self) -> int:
        """Number of processes."""
        return self._workers

    @property
    def worn(self) -> bool:
        """Whether the workers should be replaced."""
        return self._given >= LIFETIME * self._workers

    def submit(self, packed: bytes, items: tuple[WorkItem, ...]) -> "Future[Rows]":
        """Submit logs to the next free worker."""
        self._given += len(items)
        return self._pool.submit(run_items, packed, items)

    def renew(self) -> None:
        """End the workers and start others."""
        self._pool.shutdown(wait=True, cancel_futures=True)
        self._pool, self._given = self._new(), 0

    def close(self) -> None:
        """End the workers, also during a log; it has no row and the next run repeats it."""
        end(self._pool)

    def _new(self) -> ProcessPoolExecutor:
        return workers(self._workers, preload="calib.line.fleet.warm")

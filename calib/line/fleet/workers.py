"""Executors of a batch: a `Pool` of processes of this machine, or a Dask `Cluster`."""

from concurrent.futures import Future
from functools import partial
from typing import Any

from calib.base.errors import BatchError
from calib.base.extras import need
from calib.base.processes import terminate, worker_pool
from calib.line.fleet.rows import Row
from calib.line.fleet.work import WorkItem, run_items

Rows = list[Row | None]  # of a chunk, in the order of its logs; None for an unchanged log

_PRELOADED = (
    "pyarrow.csv", "pyarrow.parquet", "scipy.linalg", "scipy.optimize", "scipy.signal",
    "scipy.special", "calib.plausibility.check", "calib.fitting.fit", "calib.estimation.validate",
    "calib.line.fleet.work",
)  # fmt: skip
"""Modules that a command imports late. The process from which workers are forked imports them."""

_TIMEOUT = "10s"  # longest wait for an answer of the scheduler, in Dask's spelling


class Pool:
    """A number of ``workers``, which are processes of this machine."""

    def __init__(self, workers: int):
        self.workers = workers
        self._pool = worker_pool(workers, *_PRELOADED)

    def submit(self, packed: bytes, items: tuple[WorkItem, ...]) -> Future[Rows]:
        """Submit a pickled job and a chunk of logs; the future fails if the worker dies."""
        return self._pool.submit(run_items, packed, items)

    def renew(self) -> None:
        """End the workers and start others. Unfinished logs are lost."""
        self._pool.shutdown(wait=True, cancel_futures=True)
        self._pool = worker_pool(self.workers, *_PRELOADED)

    def close(self) -> None:
        """End the workers at once. The next run repeats the logs that this interrupts."""
        terminate(self._pool)


class Cluster:
    """The workers of Dask behind a scheduler at ``address``, such as "tcp://host:8786".

    Each worker has the logs under the same absolute paths. The class and its methods raise
    BatchError if the scheduler does not answer.
    """

    def __init__(self, address: str):
        distributed: Any = need("distributed", "dist", "--scheduler", BatchError)
        self._client: Any = None
        try:
            # without a host and a port the client ends with a traceback
            distributed.comm.addressing.get_address_host_port(address)
            self._client = distributed.Client(address, timeout=_TIMEOUT, set_as_default=False)
            self._client.wait_for_workers(1, timeout=_TIMEOUT)
        except (OSError, ValueError) as cause:
            self.close()
            problem = f"no scheduler with workers answers: {cause or type(cause).__name__}"
            expected = "the address of a Dask scheduler, like tcp://host:8786"
            do = f"start `dask scheduler`, and some `dask worker {address}`"
            raise BatchError(problem, where=address, expected=expected, do=do) from cause
        self._address = address

    @property
    def workers(self) -> int:
        """The number of threads of all workers at this moment, at least 1."""
        self._require_scheduler()
        try:
            threads: int = sum(self._client.nthreads().values())
        except OSError as cause:
            raise self._gone() from cause
        return max(1, threads)

    def submit(self, packed: bytes, items: tuple[WorkItem, ...]) -> Future[Rows]:
        """Submit a chunk as `Pool.submit`."""
        rows: Future[Rows] = Future()
        dask_future = self._client.submit(run_items, packed, items, pure=False)
        dask_future.add_done_callback(partial(_pass_on, rows))
        self._require_scheduler()  # without a scheduler the new future would never end
        return rows

    def renew(self) -> None:
        """Do no more than `_require_scheduler`: Dask itself replaces a dead worker."""
        self._require_scheduler()

    def _require_scheduler(self) -> None:
        if self._client.status != "running":
            raise self._gone()

    def _gone(self) -> BatchError:
        do = "start it and run the same command again: finished logs are kept"
        return BatchError("the scheduler is gone", where=self._address, do=do)

    def close(self) -> None:
        """Disconnect from the cluster, and drop unfinished logs."""
        if self._client is not None:
            self._client.close()


Executor = Pool | Cluster


def _pass_on(rows: Future[Rows], dask_future: Any) -> None:
    """Copy result or error of a Dask future. Dask's own executor hangs if the transfer fails."""
    try:
        rows.set_result(dask_future.result())
    except BaseException as error:
        rows.set_exception(error)

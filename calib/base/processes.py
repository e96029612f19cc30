"""Work in several processes on this machine: how they start, and how they end."""

import multiprocessing
import os
import signal
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import BrokenExecutor, ProcessPoolExecutor
from contextlib import contextmanager
from multiprocessing.context import BaseContext
from typing import Protocol, TypeVar

from calib.base.errors import BatchError

_SIGNAL_TIME = 0.3  # time in which a signal reaches all processes of a group [s]

T = TypeVar("T")
R = TypeVar("R")


class MapFunction(Protocol):
    """Type of `map` and of the functions that `parallel_map` yields."""

    def __call__(self, function: Callable[[T], R], items: Iterable[T], /) -> Iterator[R]:
        """Yield the results in the order of the items."""


def cores() -> int:
    """Number of cores that this process may use."""
    usable = getattr(os, "sched_getaffinity", None)
    return len(usable(0)) if usable else os.cpu_count() or 1


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Limit linear algebra in this process to one thread within the context.

    Matrices of some hundred rows take twice as long on two threads as on one.
    """
    import scipy.linalg.lapack  # noqa: F401  # the limit holds only for libraries loaded before it
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1, user_api="blas"):
        yield


def worker_pool(count: int, *preload: str) -> ProcessPoolExecutor:
    """Return a pool of ``count`` processes, which start with the first work.

    Each has one thread for linear algebra, unless the environment sets another number. Except on
    Windows the processes are forked from a server that has imported the modules ``preload``. They
    ignore interrupts, which their parent handles, and end when the parent ends.
    """
    for library in ("OPENBLAS", "OMP", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    context: BaseContext = multiprocessing.get_context("spawn")
    if "forkserver" in multiprocessing.get_all_start_methods():
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(list(preload))
    return ProcessPoolExecutor(count, context, initializer=_start_worker)


@contextmanager
def parallel_map(count: int, preload: str) -> Iterator[MapFunction]:
    """Yield a function like `map` that uses ``count`` processes; `map` itself if ``count`` is 1.

    ``preload`` is as for `worker_pool`. Functions must be at the top level of a module, items and
    results picklable, and a script must guard its main part. Raises BatchError if a process died.
    """
    if count <= 1:
        yield map
        return
    pool = worker_pool(count, preload)

    def mapped(function: Callable[[T], R], items: Iterable[T], /) -> Iterator[R]:
        work = list(items)
        chunk = max(1, len(work) // (3 * count))  # three for each process even out the load
        return pool.map(function, work, chunksize=chunk)

    try:
        for _ in range(count):
            pool.submit(os.getpid)  # starts a process, which imports while this process goes on
        yield mapped
    except BrokenExecutor as error:
        # if a signal to the whole group ended the worker, this process ends here without an error
        time.sleep(_SIGNAL_TIME)
        flaw = "a worker process died"
        raise BatchError(flaw, do="repeat it; if memory ran out, with --workers 1") from error
    finally:
        terminate(pool)


def terminate(pool: ProcessPoolExecutor) -> None:
    """End all processes of the pool at once."""
    for process in list((pool._processes or {}).values()):
        process.terminate()
    pool.shutdown(wait=True, cancel_futures=True)


def _start_worker() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)

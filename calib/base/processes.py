"""Processes and threads on this machine: how many, how they start, how they end."""

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

_STOPPING = 0.3  # time for a signal to reach all processes of a group [s]

T = TypeVar("T")
R = TypeVar("R")


class Mapped(Protocol):
    """Type of `map`, and of that which `side_by_side` yields."""

    def __call__(self, function: Callable[[T], R], items: Iterable[T], /) -> Iterator[R]:
        """Yield the results in the order of the items."""


def cores() -> int:
    """Number of cores that this process may use."""
    usable = getattr(os, "sched_getaffinity", None)
    return len(usable(0)) if usable else os.cpu_count() or 1


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Limit linear algebra in this process to one thread within a `with` block.

    Matrices of some hundred rows take twice as long on two threads as on one.
    """
    import scipy.linalg.lapack  # noqa: F401  # a library loaded later is not limited
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1, user_api="blas"):
        yield


def workers(count: int, *preload: str) -> ProcessPoolExecutor:
    """``count`` processes, each with one thread for linear algebra.

    Except on Windows they are forked from a server that has imported the modules ``preload``. They
    ignore interrupts, which the parent handles, and end with it.
    """
    for library in ("OPENBLAS", "OMP", "MKL"):
        os.environ.setdefault(f"{library}_NUM_THREADS", "1")
    context: BaseContext = multiprocessing.get_context("spawn")
    if "forkserver" in multiprocessing.get_all_start_methods():
        context = multiprocessing.get_context("forkserver")
        context.set_forkserver_preload(list(preload))
    return ProcessPoolExecutor(count, context, initializer=_start)


@contextmanager
def side_by_side(count: int, preload: str) -> Iterator[Mapped]:
    """Yield a `map` over ``count`` processes; `map` itself if it is 1.

    Functions must be at the top level of a module, their items and results picklable, and a script
    must guard its main part, as for every process of Python. Raises BatchError if a process died.
    """
    if count <= 1:
        yield map
        return
    pool = workers(count, preload)
    for _ in range(count):
        pool.submit(os.getpid)  # a process starts with its first work: let it import meanwhile

    def mapped(function: Callable[[T], R], items: Iterable[T], /) -> Iterator[R]:
        listed_items = list(items)
        return pool.map(function, listed_items, chunksize=max(1, len(listed_items) // (3 * count)))

    try:
        yield mapped
    except BrokenExecutor as error:
        time.sleep(_STOPPING)  # a signal to all may end this process, too, before it reports
        flaw = "a worker process died"
        raise BatchError(flaw, do="repeat it; if memory ran out, with --workers 1") from error
    finally:
        end(pool)


def end(pool: ProcessPoolExecutor) -> None:
    """Terminate the workers at once."""
    for process in list((pool._processes or {}).values()):
        process.terminate()
    pool.shutdown(wait=True, cancel_futures=True)


def _start() -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    if parent := multiprocessing.parent_process():
        parent.join()
        os._exit(1)

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

_STOPPING = 0.3
"""Time [s] within which a signal to a group of processes has come to all of them."""

T = TypeVar("T")
R = TypeVar("R")


class Mapped(Protocol):
    """How independent pieces of work are carried out: `map`, or one of `side_by_side`."""

    def __call__(self, function: Callable[[T], R], items: Iterable[T], /) -> Iterator[R]:
        """Yield the results in the order of the items."""


def cores() -> int:
    """Number of cores that this process may use."""
    usable = getattr(os, "sched_getaffinity", None)
    return len(usable(0)) if usable else os.cpu_count() or 1


@contextmanager
def one_blas_thread() -> Iterator[None]:
    """Keep the linear algebra of NumPy and SciPy to one thread meanwhile, in this process.

    Matrices of some hundred rows take twice as long on two threads as on one. The limit holds for
    the whole process, thus also for other threads of it; it is taken back at the end.
    """
    import scipy.linalg.lapack  # noqa: F401  # a library that is loaded later is not limited
    from threadpoolctl import threadpool_limits

    with threadpool_limits(1, user_api="blas"):
        yield


def workers(count: int, *preload: str) -> ProcessPoolExecutor:
    """``count`` processes, each with one thread for linear algebra.

    They are forked from a server that has imported the modules ``preload``, where the system can;
    Windows starts each anew. They ignore interrupts, which the parent handles, and end with it.
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
    """Carry out work in ``count`` processes; one after the other, in this one, if it is 1.

    Functions must be those of a module; they, their items and results must be picklable. Results
    are the same as those of `map`. A script that uses it must guard its main part, as for every
    process that Python starts. Raises BatchError if a process died.
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
        time.sleep(_STOPPING)  # what stopped the workers may stop this process, too
        flaw = "a worker process died"
        raise BatchError(flaw, do="repeat it; if memory ran out, with --workers 1") from error
    finally:
        end(pool)


def end(pool: ProcessPoolExecutor) -> None:
    """End the workers at once; what they are computing is lost."""
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

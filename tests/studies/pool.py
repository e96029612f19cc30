"""The jobs of a study, one after the other or on several processes."""

from collections.abc import Callable, Iterator
from concurrent.futures import ProcessPoolExecutor
from typing import TypeVar

Job = TypeVar("Job")
Result = TypeVar("Result")


def carried_out(tried: Callable[[Job], Result], jobs: list[Job], workers: int) -> Iterator[Result]:
    """The results in the order of the jobs; ``tried`` is a function of a module."""
    if workers == 1:
        yield from map(tried, jobs)
        return
    with ProcessPoolExecutor(workers) as pool:
        yield from pool.map(tried, jobs)

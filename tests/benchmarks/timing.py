"""How the benchmarks time a call."""

import time
from collections.abc import Callable


def best(
    call: Callable[[], object], repeat: int, clock: Callable[[], float] = time.perf_counter
) -> float:
    """Least time of several calls [s]: the one the machine disturbed least."""
    times = []
    for _ in range(repeat):
        start = clock()
        call()
        times.append(clock() - start)
    return min(times)

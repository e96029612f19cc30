"""A part of a log, by the seconds of its own clock."""

import numpy as np

from calib.errors import LogError
from calib.logs.whole import WholeLog


def cut(log: WholeLog, start: float | None = None, end: float | None = None) -> WholeLog:
    """Return the rows from ``start`` to ``end`` [s], both included; None for an end of the log.

    Raises LogError if there is no row between them, and for a log without a valid clock.
    """
    time = log.time
    first = 0 if start is None else int(np.searchsorted(time, start, side="left"))
    last = time.size if end is None else int(np.searchsorted(time, end, side="right"))
    if last <= first:
        low, high = (f"{x:g} s" if x is not None else "the end" for x in (start, end))
        raise LogError(
            f"no sample from {low if start is not None else 'the start'} to {high}",
            where=log.source,
            expected=f"times from {time[0]:g} to {time[-1]:g} s",
        )
    return log.rows(first, last)

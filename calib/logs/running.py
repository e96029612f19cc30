"""Correct the timestamps of a recorder: counters that wrap, frames out of order.

written   4294.960  4294.965  0.003  0.008     a counter of 32 bits, in microseconds
result    4294.960  4294.965  4294.970  ...    its period is added after the wrap
"""

import numpy as np

from calib.errors import LogError
from calib.logs.source import Array

PERIODS = {
    "32 bits of nanoseconds": 2**32 * 1e-9,
    "16 bits of milliseconds": 2**16 * 1e-3,
    "32 bits of microseconds": 2**32 * 1e-6,
    "32 bits of 10 microseconds": 2**32 * 1e-5,
    "one day": 86400.0,
    "32 bits of milliseconds": 2**32 * 1e-3,
}
"""Periods after which recorder counters wrap [s]."""

MISSED = 1.0
"""A step back is a wrap if it is shorter than a period by at most this [s]."""

DISORDER = 0.1
"""Frames of several buses may be out of order by at most this [s]."""

DISORDERED = 0.25
"""Largest share of frames out of order [1]; with more, the timestamps have another meaning."""


def running(written: Array, where: str) -> tuple[Array, tuple[str, ...]]:
    """Undo the wrapping of timestamps.

    Parameters
    ----------
    written : timestamps [s] in the order of the file, shape (n,).
    where : the file's path, for messages.

    Returns
    -------
    The timestamps without wraps [s], in the order of the file, shape (n,), and notes.
    Raises LogError for a step back that is not a wrap of a known counter, and for timestamps that
    are not in order. A gap longer than the period of the counter cannot be detected.
    """
    steps = np.diff(written)
    if not np.isfinite(written).all():
        raise LogError("a timestamp is not a number", where=where, do="export the log again")
    if np.count_nonzero(steps < 0) > max(DISORDERED * written.size, 1):
        raise LogError(
            f"{np.count_nonzero(steps < 0)} of {written.size} timestamps are not increasing",
            where=where,
            expected="times since the start, not since the frame before",
            do="export with absolute timestamps",
        )
    time, notes = written.astype(np.float64), []
    for i in np.flatnonzero(steps < -DISORDER):
        name, period = _period(float(-steps[i]), f"{where}: sample {i + 2}", float(written[i]))
        time[i + 1 :] += period
        notes.append(f"the clock wrapped after {written[i]:.6g} s ({name}): {period:.6f} s added")
    return time, tuple(notes)


def _period(back: float, where: str, last: float) -> tuple[str, float]:
    for name, period in PERIODS.items():
        if 0.0 <= period - back <= MISSED:
            return name, period
    raise LogError(
        f"time goes back by {back:.6g} s, from {last:.6g} s",
        where=where,
        expected="increasing times, or a counter that wraps after "
        + ", ".join(f"{p:.6g} s" for p in PERIODS.values()),
        do="two recordings in one file? split them",
    )

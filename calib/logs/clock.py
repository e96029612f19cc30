"""The times of a log: the step of a clock, and even clocks of few digits.

true      0.00000  0.00667  0.01333  0.02000      150 Hz
written   0.000    0.007    0.013    0.020        whole milliseconds: steps of 7 and of 6 ms
result    0.00000  0.00667  0.01333  0.02000      the line through all times: one even step
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError

GAP = 3.5
"""A longer step than this many usual ones [1] is a gap: two lost samples, plus jitter, are none."""

VALUES = 4
"""Most values that the steps of a rounded even clock have: two, or four where the spacing of
float32 doubles within the log. A clock that jitters has many."""

_FINE = 1e-3
"""Rounding below this [steps] is left alone: it moves no result."""


def is_ascending(time: Array) -> bool:
    """Whether every time is a number, and later than the one before."""
    return bool(np.isfinite(time).all() and np.all(np.diff(time) > 0))


def step_of(time: Array) -> float:
    """Mean step of ascending times, (n,), without gaps [s].

    Not the median: of whole milliseconds at 300 Hz that is 3 ms where 3.33 ms is true.
    """
    steps = np.diff(time)
    gaps = steps[steps > GAP * np.median(steps)]
    return float((time[-1] - time[0] - gaps.sum()) / (steps.size - gaps.size))


_FEW = 50
"""Fewest times that show whether a clock is even."""


def on_line(time: Array) -> tuple[Array, tuple[str, ...]]:
    """Ascending times [s], as `evened` has them, and what is to be said of it."""
    line = evened(time) if time.size >= _FEW else None
    if line is None:
        return time, ()
    values, rounding = line
    note = (
        f"times are written in steps of {1e3 * rounding:.3g} ms; they were put on the even clock "
        f"of {step_of(values) * 1e3:.6g} ms that they lie on"
    )
    return values, (note,)


def evened(time: Array) -> tuple[Array, float] | None:
    """The line of an even clock that was written with few digits, and the rounding [s].

    ``time`` [s], (n,), ascends and may have gaps. None for a clock that jitters by more than its
    last digit, and for one with digits enough.
    """
    steps = np.diff(time)
    # one slope for the lines through the times between gaps: least squares
    part = np.concatenate([[0], np.cumsum(steps > GAP * step_of(time))])
    row = np.concatenate([[0.0], np.cumsum(np.round(steps / step_of(time)))])
    size = np.bincount(part)
    along, later = (x - (np.bincount(part, x) / size)[part] for x in (row, time))
    step = float(along @ later / (along @ along))
    counts = np.round(steps / step)
    single = np.unique(np.round(steps[counts == 1] / step, 6)) * step
    if counts.min() < 1.0 or not 2 <= single.size <= VALUES:
        return None
    if single[-1] - single[0] < _FINE * step:
        return None
    row = np.concatenate([[0.0], np.cumsum(counts)])
    slope, start = np.polynomial.polynomial.Polynomial.fit(row, time, 1).convert().coef[::-1]
    line = start + slope * row
    rounding = float(single[-1] - single[0])
    if np.max(np.abs(line - time)) > rounding:
        return None
    return np.asarray(line), rounding


_DISORDER = 0.1
"""Frames of several buses may be out of order by at most this [s]."""

_DISORDERED = 0.25
"""Largest share of frames out of order [1]; with more, the timestamps have another meaning."""


def check_running(time: Array, where: str) -> None:
    """Raise LogError for timestamps [s], (n,), in the order of the file, that are out of order."""
    steps = np.diff(time)
    if not np.isfinite(time).all():
        raise LogError("a timestamp is not a number", where=where, do="export the log again")
    if np.count_nonzero(steps < 0) > max(_DISORDERED * time.size, 1):
        raise LogError(
            f"{np.count_nonzero(steps < 0)} of {time.size} timestamps are not increasing",
            where=where,
            expected="times since the start, not since the frame before",
            do="export with absolute timestamps",
        )
    back = np.flatnonzero(steps < -_DISORDER)
    if back.size:
        row = int(back[0])
        raise LogError(
            f"time goes back by {-steps[row]:.6g} s, from {time[row]:.6g} s",
            where=f"{where}: sample {row + 2}",
            expected="increasing times",
            do="two recordings in one file? split them",
        )

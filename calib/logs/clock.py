"""The times of a log: the step of a clock, even clocks of few digits, and counters that wrap.

true      0.00000  0.00667  0.01333  0.02000      150 Hz
written   0.000    0.007    0.013    0.020        whole milliseconds: steps of 7 and of 6 ms
result    0.00000  0.00667  0.01333  0.02000      the line through all times: one even step

written   4294.960  4294.965  0.003  0.008     a counter of 32 bits, in microseconds
result    4294.960  4294.965  4294.970  ...    its period is added after the wrap
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
    step = _slope(time, steps)
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


def _slope(time: Array, steps: Array) -> float:
    """Step [s] of the lines through the times between gaps, one slope for all: least squares."""
    part = np.concatenate([[0], np.cumsum(steps > GAP * step_of(time))])
    row = np.concatenate([[0.0], np.cumsum(np.round(steps / step_of(time)))])
    size = np.bincount(part)
    along, later = (x - (np.bincount(part, x) / size)[part] for x in (row, time))
    return float(along @ later / (along @ along))


PERIODS = {
    "32 bits of nanoseconds": 2**32 * 1e-9,
    "16 bits of milliseconds": 2**16 * 1e-3,
    "32 bits of microseconds": 2**32 * 1e-6,
    "32 bits of 10 microseconds": 2**32 * 1e-5,
    "one day": 86400.0,
    "32 bits of milliseconds": 2**32 * 1e-3,
}
"""Periods after which recorder counters wrap [s]."""

_MISSED = 1.0
"""A step back is a wrap if it is shorter than a period by at most this [s]."""

_DISORDER = 0.1
"""Frames of several buses may be out of order by at most this [s]."""

_DISORDERED = 0.25
"""Largest share of frames out of order [1]; with more, the timestamps have another meaning."""


def running(written: Array, where: str) -> tuple[Array, tuple[str, ...]]:
    """Timestamps [s] in the order of the file, (n,), without wraps, and notes.

    Raises LogError for times that are out of order, or step back by no period of a known counter.
    """
    steps = np.diff(written)
    if not np.isfinite(written).all():
        raise LogError("a timestamp is not a number", where=where, do="export the log again")
    if np.count_nonzero(steps < 0) > max(_DISORDERED * written.size, 1):
        raise LogError(
            f"{np.count_nonzero(steps < 0)} of {written.size} timestamps are not increasing",
            where=where,
            expected="times since the start, not since the frame before",
            do="export with absolute timestamps",
        )
    time, notes = written.astype(np.float64), []
    for i in np.flatnonzero(steps < -_DISORDER):
        name, period = _period(float(-steps[i]), f"{where}: sample {i + 2}", float(written[i]))
        time[i + 1 :] += period
        notes.append(f"the clock wrapped after {written[i]:.6g} s ({name}): {period:.6f} s added")
    return time, tuple(notes)


def _period(back: float, where: str, last: float) -> tuple[str, float]:
    for name, period in PERIODS.items():
        if 0.0 <= period - back <= _MISSED:
            return name, period
    raise LogError(
        f"time goes back by {back:.6g} s, from {last:.6g} s",
        where=where,
        expected="increasing times, or a counter that wraps after "
        + ", ".join(f"{p:.6g} s" for p in PERIODS.values()),
        do="two recordings in one file? split them",
    )

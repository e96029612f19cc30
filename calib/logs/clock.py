"""The times of a log: the step of a clock, even clocks of few digits, impossible clocks.

true      0.00000  0.00667  0.01333  0.02000      150 Hz
written   0.000    0.007    0.013    0.020        whole milliseconds: steps of 7 and of 6 ms
result    0.00000  0.00667  0.01333  0.02000      the line through all times: one even step
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.plain import counted
from calib.base.units import QUANTITIES, to_si

REPEATED = 0.01  # largest share of rows [1] that repeat the time of the row before them
GAP = 3.5
"""A longer step than this many usual ones [1] is a gap: two lost samples, plus jitter, are none."""
VALUES = 4
"""Most values of the steps of a rounded even clock: 2, or 4 where steps of float32 double."""
_FINE = 1e-3  # rounding below this [steps] is left alone: it moves no result


def is_ascending(time: Array) -> bool:
    """Whether every time is a number, and later than the one before."""
    return bool(np.isfinite(time).all() and np.all(time[1:] > time[:-1]))


def step_of(time: Array) -> float:
    """Mean step of ascending times, (n,), without gaps [s].

    Not the median: of whole milliseconds at 300 Hz that is 3 ms where 3.33 ms is true.
    """
    steps = np.diff(time)
    gaps = steps[steps > GAP * np.median(steps)]
    return float((time[-1] - time[0] - gaps.sum()) / (steps.size - gaps.size))


def on_line(time: Array) -> tuple[Array, tuple[str, ...]]:
    """Put times [s] (n,) of an even clock that were written with few digits on its line.

    Returns them and a note; or as they are, where the clock has more jitter than rounding.
    """
    if time.size < _MIN_SAMPLES:
        return time, ()
    usual, steps = step_of(time), np.diff(time)
    # one slope for the lines through the times between gaps: least squares
    part = np.concatenate([[0], np.cumsum(steps > GAP * usual)])
    index = np.concatenate([[0.0], np.cumsum(np.round(steps / usual))])
    size = np.bincount(part)
    x, y = (values - (np.bincount(part, values) / size)[part] for values in (index, time))
    step = float(x @ y / (x @ x))
    counts = np.round(steps / step)
    single = np.unique(np.round(steps[counts == 1] / step, 6)) * step
    if counts.min() < 1.0 or not 2 <= single.size <= VALUES:
        return time, ()
    rounding = float(single[-1] - single[0])
    index = np.concatenate([[0.0], np.cumsum(counts)])
    slope, start = np.polynomial.polynomial.Polynomial.fit(index, time, 1).convert().coef[::-1]
    line = np.asarray(start + slope * index)
    if rounding < _FINE * step or np.max(np.abs(line - time)) > rounding:
        return time, ()
    note = (
        f"times are written in steps of {1e3 * rounding:.3g} ms; they were put on the even clock "
        f"of {step_of(line) * 1e3:.6g} ms that they lie on"
    )
    return line, (note,)


LATEST = 1e12  # no time is later [s]: far above seconds since 1970
_DISORDER = 0.1  # longest step back [s] between frames of several buses
_DISORDERED = 0.25
"""Largest share of frames out of order [1]; with more, the timestamps have another meaning."""


def check_running(time: Array, where: str) -> None:
    """Raise LogError for timestamps [s], (n,), in the order of the file, that are out of order."""
    if not (np.abs(time) < LATEST).all():
        raise LogError("a timestamp is no time", where=where, do="export the log again")
    disordered = int(np.count_nonzero(time[1:] < time[:-1]))
    if disordered > max(_DISORDERED * time.size, 1):
        raise LogError(
            f"{disordered} of {time.size} timestamps are not increasing",
            where=where,
            expected="times since the start, not since the frame before",
            do="export with absolute timestamps",
        )
    back = np.flatnonzero(time[1:] < time[:-1] - _DISORDER)
    if back.size:
        row = int(back[0])
        raise LogError(
            f"time goes back by {time[row] - time[row + 1]:.6g} s, from {time[row]:.6g} s",
            where=f"{where}: sample {row + 2}",
            expected="increasing times",
            do="two recordings in one file? split them",
        )


_MIN_SAMPLES = 50  # fewest samples of a log: a quarter of a second at 200 Hz, too short to filter
_RATES = 40.0, 1000.0  # sample rates that a log can have [Hz]
TIME_UNITS = {unit: to_si(1.0, unit, "s") for unit in QUANTITIES["s"][1]}
"""Units that a time is written in [s]."""
_BURST = 0.25  # a step shorter than this share of the mean one [1] is within a burst
_BURSTS = 0.1
"""Largest share of such steps [1]: frames of a bus wait for each other by a tenth of a step."""
_STANDING = 0.3  # least share of jumps in a log whose milliseconds have too many digits [1]


def check_clock(time: Array, where: str, unit: str = "s") -> None:
    """Check ``time`` [s], shape (n,): enough samples, increasing, and `check_steps`."""
    if time.size < _MIN_SAMPLES:
        raise LogError(
            f"only {time.size} samples", where=where, expected=f"at least {_MIN_SAMPLES}"
        )
    check_increasing(time, where)
    check_steps(time, where, unit)


def check_steps(time: Array, where: str, unit: str = "s") -> None:
    """Check the steps of an increasing time [s] (n,), as a recorder makes them.

    ``unit`` is that in which it was written. Raises LogError for another unit, for a clock that
    jumps over a part of each second, and for samples that come in bursts.
    """
    steps = np.diff(time)
    usual, mean = float(np.median(steps)), float(np.mean(steps))
    low, high = (1.0 / rate for rate in reversed(_RATES))
    written = usual / to_si(1.0, unit, "s")
    likely = [other for other, size in TIME_UNITS.items() if low <= written * size <= high]
    if likely and not 0.2 * low <= usual <= 5.0 * high:
        raise LogError(
            f"is the time in {likely[0]}, not {unit}? the step would be {_duration(usual)}",
            where=f"{where}: time",
            expected=f"a rate of {_RATES[0]:.0f} Hz to {_RATES[1] / 1e3:.0f} kHz",
            do="correct the header, or give the unit in a channel map",
        )
    # milliseconds with four digits count a tenth of each second, and jump
    jumps = np.flatnonzero(steps > 10.0 * usual)
    often = jumps.size > 1 and steps[jumps].sum() >= _STANDING * (time[-1] - time[0])
    if often and np.allclose(np.diff(time[jumps]), 1.0, atol=0.05):
        jump = float(np.median(steps[jumps]))
        raise LogError(
            f"the clock jumps by {jump:.2g} s in every second, and counts only the rest",
            where=f"{where}: time",
            expected="parts of a second that go up to the next one",
            do="are its milliseconds written with more than three digits? export the time in s",
        )
    if np.mean(steps < _BURST * mean) > _BURSTS:
        long = float(np.median(steps[steps > mean]))
        raise LogError(
            f"samples come in bursts, every {_duration(long)}: their times are those at which an "
            "adapter handed them out",
            where=f"{where}: time",
            expected="the time at which each was sent or measured",
            do="record with time stamps of the hardware, or lower the latency of the adapter",
        )


def _duration(seconds: float) -> str:
    """A duration in the largest unit of which it has one or more.

    >>> _duration(5e-6), _duration(0.0251), _duration(1000.0)
    ('5 us', '25.1 ms', '16.7 min')
    """
    size, unit = max((s, u) for u, s in TIME_UNITS.items() if s <= max(seconds, 1e-6))
    return f"{seconds / size:.3g} {unit}"


def check_increasing(time: Array, where: str) -> None:
    """Check that ``time`` [s], shape (n,), is strictly increasing. Raises LogError."""
    lost = np.flatnonzero(~np.isfinite(time))
    if lost.size:
        raise LogError(
            f"no time in row {lost[0] + 1} ({counted(lost.size, 'such row')})",
            where=f"{where}: time",
            expected="a number in every row",
            do="export again",
        )
    wrong = np.flatnonzero(~(np.diff(time) > 0))
    if wrong.size == 0:
        return
    row = int(wrong[0]) + 1
    back = time[row] < time[row - 1]
    raise LogError(
        f"time {'goes back' if back else 'does not increase'} in row {row + 1}, to "
        f"{time[row] - time[0]:.6f} s after {time[row - 1] - time[0]:.6f} s since the start "
        f"({counted(wrong.size, 'such row')})",
        where=f"{where}: time",
        expected="strictly increasing time",
        do="sort the rows by time, or split runs whose time begins again"
        if back
        else "export again, or delete the repeated rows",
    )

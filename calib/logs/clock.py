"""The times of a log: mean step, repair of rounded times, errors of clocks.

`on_line` repairs an even clock whose times were written with few digits:

true      0.00000  0.00667  0.01333  0.02000      150 Hz
written   0.000    0.007    0.013    0.020        whole milliseconds: steps of 7 and of 6 ms
result    0.00000  0.00667  0.01333  0.02000      the line through all times: one even step

`check_running` checks the times of frames, in the order of the file, before they are sorted.
`check_clock` checks the times of a table or of a resampled recording.
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.plain import counted
from calib.base.units import QUANTITIES, to_si

REPEATED = 0.01  # largest share of rows [1] that repeat the time of the row before them
GAP = 3.5  # a step longer than this many usual steps [1] is a gap; two lost samples make 3
_MIN_SAMPLES = 50  # fewest samples of a log: 0.25 s at 200 Hz; fewer cannot be filtered
_MOST_ROUNDED_STEPS = 4
"""Most different steps between the rounded times of an even clock. There are 2; or 4 if a number of
32 bits grows past a power of two, where its resolution doubles."""
_FINE = 1e-3  # rounding below this share of a step [1] moves no result, and is not repaired


def is_ascending(time: Array) -> bool:
    """Whether every time is a number, and later than the one before."""
    return bool(np.isfinite(time).all() and np.all(time[1:] > time[:-1]))


def step_of(time: Array) -> float:
    """Mean step [s] of ascending times (n,) [s], without the gaps.

    The median would be wrong for rounded times: 3 ms instead of 3.33 ms at 300 Hz in whole ms.
    """
    steps = np.diff(time)
    gaps = steps[steps > GAP * np.median(steps)]
    return float((time[-1] - time[0] - gaps.sum()) / (steps.size - gaps.size))


def on_line(time: Array) -> tuple[Array, tuple[str, ...]]:
    """Undo the rounding of the times [s] (n,) of an even clock.

    Return the straight line through the times and a note; or, if they do not lie on a line within
    their rounding, the times themselves and no note.
    """
    if time.size < _MIN_SAMPLES:
        return time, ()
    steps, step = np.diff(time), _slope(time)
    counts = np.round(steps / step)  # steps of the clock from row to row: 1, or more at a gap
    rounded_steps = np.unique(np.round(steps[counts == 1] / step, 6)) * step
    if counts.min() < 1.0 or not 2 <= rounded_steps.size <= _MOST_ROUNDED_STEPS:
        return time, ()
    rounding = float(rounded_steps[-1] - rounded_steps[0])  # resolution of the times [s]
    number = np.concatenate([[0.0], np.cumsum(counts)])
    start, slope = np.polynomial.polynomial.Polynomial.fit(number, time, 1).convert().coef
    line = np.asarray(start + slope * number)
    if rounding < _FINE * step or np.max(np.abs(line - time)) > rounding:
        return time, ()
    even_clock = f"the even clock of {step_of(line) * 1e3:.6g} ms that they lie on"
    written = f"times are written in steps of {1e3 * rounding:.3g} ms"
    return line, (f"{written}; they were put on {even_clock}",)


def _slope(time: Array) -> float:
    """Step [s] of an even clock: the common slope, by least squares, of the parts between gaps."""
    mean, steps = step_of(time), np.diff(time)
    part = np.concatenate([[0], np.cumsum(steps > GAP * mean)])  # (n,) index of the part
    number = np.concatenate([[0.0], np.cumsum(np.round(steps / mean))])
    size = np.bincount(part)  # (parts,) number of samples
    x = number - (np.bincount(part, number) / size)[part]  # (n,) less the mean of the part
    y = time - (np.bincount(part, time) / size)[part]
    return float(x @ y / (x @ x))


LATEST = 1e12  # latest time that a log can have [s]: far above the seconds since 1970
_STEP_BACK = 0.1  # longest step back in time [s] between frames of several buses
_STEPS_BACK = 0.25  # largest share of frames before which time steps back [1]


def check_running(time: Array, where: str) -> None:
    """Raise LogError if timestamps [s] (n,), in the order of the file, step back far or often."""
    if not (np.abs(time) < LATEST).all():
        raise LogError("a timestamp is no time", where=where, do="export the log again")
    steps_back = int(np.count_nonzero(time[1:] < time[:-1]))
    if steps_back > max(_STEPS_BACK * time.size, 1):
        flaw = f"{steps_back} of {time.size} timestamps are not increasing"
        expected = "times since the start, not since the frame before"
        do = "export with absolute timestamps"
        raise LogError(flaw, where=where, expected=expected, do=do)
    long_steps_back = np.flatnonzero(time[1:] < time[:-1] - _STEP_BACK)
    if long_steps_back.size:
        row = int(long_steps_back[0])
        flaw = f"time goes back by {time[row] - time[row + 1]:.6g} s, from {time[row]:.6g} s"
        place, do = f"{where}: sample {row + 2}", "two recordings in one file? split them"
        raise LogError(flaw, where=place, expected="increasing times", do=do)


_RATES = 40.0, 1000.0  # lowest and highest sample rate of a log [Hz]
_FAR = 5.0  # factor beyond these rates [1] from which a wrong unit is likelier than an odd rate
TIME_UNITS = {unit: to_si(1.0, unit, "s") for unit in QUANTITIES["s"][1]}
"""Size [s] of each unit of time."""
_BURST = 0.25  # a step shorter than this share of the mean step [1] lies within a burst
_BURSTS = 0.1  # largest share of such steps [1]; a few are normal, as bus frames wait for others
_FEWEST_BURSTS = 5  # fewest long steps between bursts; fewer are jumps of the clock


def check_clock(time: Array, where: str, unit: str) -> None:
    """Raise LogError unless ``time`` [s] (n,), which the file has in ``unit``, is that of a log."""
    if time.size < _MIN_SAMPLES:
        expected = f"at least {_MIN_SAMPLES}"
        raise LogError(f"only {time.size} samples", where=where, expected=expected)
    check_increasing(time, where)
    _check_unit(time, where, unit)
    _check_bursts(time, where)


def check_increasing(time: Array, where: str) -> None:
    """Raise LogError unless ``time`` [s] (n,) is strictly increasing."""
    lost = np.flatnonzero(~np.isfinite(time))
    if lost.size:
        flaw = f"no time in row {lost[0] + 1} ({counted(lost.size, 'such row')})"
        expected, do = "a number in every row", "export again"
        raise LogError(flaw, where=f"{where}: time", expected=expected, do=do)
    wrong = np.flatnonzero(~(np.diff(time) > 0))
    if wrong.size == 0:
        return
    row = int(wrong[0]) + 1
    kind, do = _disorder(time, row)
    step = f"to {time[row] - time[0]:.6f} s after {time[row - 1] - time[0]:.6f} s since the start"
    flaw = f"time {kind} in row {row + 1}, {step} ({counted(wrong.size, 'such row')})"
    raise LogError(flaw, where=f"{where}: time", expected="strictly increasing time", do=do)


def _disorder(time: Array, row: int) -> tuple[str, str]:
    """Return what ``time`` [s] (n,) does in ``row`` instead of increasing, and what to do."""
    steps, sorted_steps = np.diff(time), np.diff(np.sort(time))
    usual = float(np.median(sorted_steps))
    if np.all(steps < 0.0):
        return "goes back", "give the time its sign again, or export it as time since the start"
    if steps[row - 1] == 0.0:
        if np.mean(steps == 0.0) > REPEATED:
            return "does not increase", "export it with more digits, or with a clock that runs"
        return "does not increase", "export again, or delete the repeated rows"
    if np.all((sorted_steps > _BURST * usual) & (sorted_steps < GAP * usual)):
        return "goes back", "sort the rows by time"
    add = f"add {usual - steps[row - 1]:.6f} s from this row on"
    do = (
        f"if its counter overflowed or its clock was set, {add}; split runs whose time begins again"
    )
    return "goes back", do


def _check_unit(time: Array, where: str, unit: str) -> None:
    """Raise LogError if another unit of time gives a likely sample rate, and ``unit`` does not."""
    median = float(np.median(np.diff(time)))
    shortest, longest = 1.0 / _RATES[1], 1.0 / _RATES[0]
    written_step = median / to_si(1.0, unit, "s")
    likely = [u for u, size in TIME_UNITS.items() if shortest <= written_step * size <= longest]
    if likely and not shortest / _FAR <= median <= longest * _FAR:
        flaw = f"is the time in {likely[0]}, not {unit}? the step would be {_duration(median)}"
        expected = f"a rate of {_RATES[0]:.0f} Hz to {_RATES[1] / 1e3:.0f} kHz"
        do = "correct the header, or give the unit in a channel map"
        raise LogError(flaw, where=f"{where}: time", expected=expected, do=do)


def _check_bursts(time: Array, where: str) -> None:
    """Raise LogError if many steps of ``time`` [s] (n,) are far below the mean step."""
    steps = np.diff(time)
    mean = float(np.mean(steps))
    if np.mean(steps < _BURST * mean) <= _BURSTS:
        return
    pauses = np.flatnonzero(steps > mean)
    pause = float(np.median(steps[pauses]))
    is_every_second = np.allclose(np.diff(time[pauses]), 1.0, atol=0.05)
    if pauses.size > 1 and is_every_second:  # 0.999 s was written as .0999, and then comes 1.0000
        flaw = f"the clock jumps by {pause:.2g} s in every second, and counts only the rest"
        expected = "parts of a second that go up to the next one"
        do = "are its milliseconds written with more than three digits? export the time in s"
    elif pauses.size < _FEWEST_BURSTS:
        raise _jump(time, where)
    else:
        bursts = f"samples come in bursts, every {_duration(pause)}"
        flaw = f"{bursts}: their times are those at which an adapter handed them out"
        expected = "the time at which each was sent or measured"
        do = "record with time stamps of the hardware, or lower the latency of the adapter"
    raise LogError(flaw, where=f"{where}: time", expected=expected, do=do)


def _jump(time: Array, where: str) -> LogError:
    """Return the error for the largest jump of a clock in its ``time`` [s] (n,)."""
    steps = np.diff(time)
    row = int(np.argmax(steps)) + 1
    set_back = "if the clock was set, as to summer time, subtract the jump from the rows after it"
    do = f"cut the log there if two recordings were joined; {set_back}"
    # a time of day written as the number hhmmss jumps from ..59 to ..00 of the next hundred
    second, next_second = time[row - 1] % 100.0, time[row] % 100.0
    two_steps = 2.0 * np.median(steps)
    if second < 60.0 <= second + two_steps and next_second < two_steps:
        do = f"if this is the time of day as hhmmss, convert it to seconds; {do}"
    flaw = f"the clock jumps by {steps[row - 1]:.6g} s in row {row + 1}"
    return LogError(flaw, where=f"{where}: time", expected="times of one recording", do=do)


def _duration(seconds: float) -> str:
    """Write a duration in the largest unit of which it has at least one: ``25.1 ms``."""
    size, unit = max((s, u) for u, s in TIME_UNITS.items() if s <= max(seconds, 1e-6))
    return f"{seconds / size:.3g} {unit}"

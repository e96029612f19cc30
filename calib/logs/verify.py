"""Check that a log is valid: complete values, increasing time, enough samples."""

from collections.abc import Mapping

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.names import CHANNELS
from calib.base.plain import counted
from calib.base.units import spelling
from calib.logs.gaps import ONLY

_MIN_SAMPLES = 50
"""Fewest samples of a log: a quarter of a second at 200 Hz, too short to filter."""

_ABSURD = {"Pa": 1e9, "m/s^2": 1e4, "rad/s": 1e5, "m/s": 1e4, "rad": 1e4, "N*m": 1e7, "degC": 1e5}
"""By SI unit: far above all values that a car can have, and that a wrong unit can make of them."""
_ABSURD_ELSE = 1e12
"""Above seconds since 1970, too."""


ENDS = 1.0
"""Longest time [s] at the start or the end of a log for which a channel may have no value."""


def without_open_ends(channels: dict[str, Array]) -> tuple[dict[str, Array], tuple[str, ...]]:
    """The rows from the first value of the last channel that begins to the first last value.

    ``channels`` by name, (n,) each, are NaN where they have no value. One without a value for more
    than `ENDS` [s] at an end counts as one with a gap. Returns (m,) each, and a note.
    """
    time = channels.get("time")
    if time is None or not np.isfinite(time).all():
        return channels, ()
    begin, end, late = 0, time.size, list[str]()
    for name, values in channels.items():
        present = np.flatnonzero(~np.isnan(values)) if name in CHANNELS else np.empty(0, np.intp)
        if not present.size:
            continue
        first, last = int(present[0]), int(present[-1])
        if time[first] - time[0] > ENDS or time[-1] - time[last] > ENDS:
            continue
        if first > 0 or last + 1 < time.size:
            late.append(name)
        begin, end = max(begin, first), min(end, last + 1)
    if not late or begin >= end:
        return channels, ()
    note = (
        f"{', '.join(late)}: no value at the start or the end; "
        f"the first {begin} and the last {time.size - end} rows were left out"
    )
    return {name: values[begin:end] for name, values in channels.items()}, (note,)


def complete_channels(
    channels: dict[str, Array], require: tuple[str, ...], where: str
) -> tuple[dict[str, Array], tuple[str, ...]]:
    """The channels that are finite in every row, and a note on each dropped one.

    Raises LogError for an empty one in ``require``, and for missing values in what every log has.
    """
    kept, notes = {}, []
    for name, values in channels.items():
        bad = np.flatnonzero(~np.isfinite(values))
        if bad.size == 0:
            kept[name] = values
        elif np.isnan(values).all():
            if name in require:
                raise LogError(
                    f"the channel is empty: no value in {values.size} rows",
                    where=f"{where}: {name}",
                    expected="a value in every row",
                    do="run `brake-cal check`: it lists the remaining uses of the log",
                )
            notes.append(f"{name} is empty and was left out")
        elif name in CHANNELS and CHANNELS[name].required:
            first = int(bad[0])
            kind = "no value" if np.isnan(values[first]) else "an infinite value"
            raise LogError(
                f"{kind} in {bad.size} of {values.size} rows, first in row {first + 1}, "
                f"{channels['time'][first] - channels['time'][0]:.3f} s after the start",
                where=f"{where}: {name}",
                expected="a finite value in every row",
                do="export all channels on one clock, or cut the log before the gap: a gap is "
                f"bridged {ONLY}",
            )
        else:
            notes.append(
                f"{name} has no value in {bad.size} of {values.size} rows, "
                f"first in row {bad[0] + 1}, and was left out"
            )
    return kept, tuple(notes)


def refuse_absurd(channels: Mapping[str, Array], where: str) -> None:
    """Raise LogError for a value so large that the file must be damaged; channels in SI by name."""
    for name, values in channels.items():
        most = _ABSURD.get(CHANNELS[name].si, _ABSURD_ELSE) if name in CHANNELS else _ABSURD_ELSE
        absurd = np.flatnonzero(np.isfinite(values) & (np.abs(values) > most))
        if absurd.size:
            row = int(absurd[0])
            raise LogError(
                f"row {row + 1} holds {values[row]:.3g} (SI)",
                where=f"{where}: {name}",
                expected="a value that can be measured",
                do="the file is damaged or the unit is wrong: export it again",
            )


_RATES = 40.0, 1000.0
"""Sample rates that a log can have [Hz]."""
_UNITS = {"us": 1e-6, "ms": 1e-3, "s": 1.0, "min": 60.0, "h": 3600.0, "d": 86400.0}
"""Units that a time is written in [s]."""
_BURST = 0.25
"""A step shorter than this share of the mean one follows at once: what is handed out together."""
_BURSTS = 0.1
"""Largest share of such steps [1]: frames of a bus wait for each other by a tenth of a step."""
_STANDING = 0.3
"""Share of a log that its clock jumps over, every second, where it has too many digits [1]."""


def check_clock(time: Array, where: str, unit: str = "s") -> None:
    """Check ``time`` [s], shape (n,): enough samples, increasing, and `check_steps`."""
    if time.size < _MIN_SAMPLES:
        raise LogError(
            f"only {time.size} samples", where=where, expected=f"at least {_MIN_SAMPLES}"
        )
    check_increasing(time, where)
    check_steps(time, where, unit)


def check_steps(time: Array, where: str, unit: str = "s") -> None:
    """Check that an increasing time [s] (n,) has steps that a recorder makes.

    ``unit`` is that in which it was written. Raises LogError for another unit, for a clock that
    jumps over a part of each second, and for samples that come in bursts.
    """
    steps = np.diff(time)
    usual, mean = float(np.median(steps)), float(np.mean(steps))
    low, high = (1.0 / rate for rate in reversed(_RATES))
    written = usual / _UNITS.get(spelling(unit), 1.0)
    meant = [other for other, size in _UNITS.items() if low <= written * size <= high]
    if meant and not 0.2 * low <= usual <= 5.0 * high:
        raise LogError(
            f"the unit of the time is {unit}: the step would be {usual:.3g} s",
            where=f"{where}: time",
            expected=f"a rate of {_RATES[0]:.0f} Hz to {_RATES[1] / 1e3:.0f} kHz",
            do=f"is it in {meant[0]}? correct the header, or give the unit in a channel map",
        )
    # milliseconds with four digits count a tenth of each second, and jump
    jumps = np.flatnonzero(steps > 10.0 * usual)
    often = jumps.size > 1 and steps[jumps].sum() >= _STANDING * (time[-1] - time[0])
    if often and np.allclose(np.diff(time[jumps]), 1.0, atol=0.05):
        jump = float(np.median(steps[jumps]))
        raise LogError(
            f"the clock counts {1.0 - jump:.2g} s of every second, and jumps by {jump:.2g} s",
            where=f"{where}: time",
            expected="parts of a second that go up to the next one",
            do="are its milliseconds written with more than three digits? export the time in s",
        )
    if np.mean(steps < _BURST * mean) > _BURSTS:
        long = float(np.median(steps[steps > mean]))
        raise LogError(
            f"samples come in bursts, every {1e3 * long:.3g} ms: their times are those at which an "
            "adapter handed them out",
            where=f"{where}: time",
            expected="the time at which each was sent or measured",
            do="record with time stamps of the hardware, or lower the latency of the adapter",
        )


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
        do="export again, or delete the repeated rows",
    )

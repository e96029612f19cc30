"""Bridge the short gaps of a channel, such as those of lost CAN messages, with straight lines.

. . . .------. . . .    the lines through both sides meet in the middle: the gap is bridged

             . . . .
. . . .                 they do not: something happened in the gap, which stays open

Where gaps stay open, the ends of the log are cut (`without_open_ends`), and channels that no
calibration needs are left out (`complete_channels`).
"""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.names import CHANNELS
from calib.base.plain import counted
from calib.logs.clock import GAP, check_increasing, is_ascending, step_of

BRIDGE = 0.2  # longest gap that is bridged [s]: a brake pressure can build up in a longer one
_SIDE = 0.1  # time on either side of a gap [s] in which the channel must be smooth
_NEAR = 0.5  # time on either side of a gap [s] whose samples show the noise of the channel
_FEWEST = 4  # fewest samples of a side: a line fits three samples too easily
INSTANT = 1e-9  # shortest step of a clock [s]: recorders count no finer
_SMOOTH = 0.01  # largest error of a bridge besides the noise, over the channel's range [1]
ENDS = 1.0  # longest time [s] at either end of a log for which a channel may have no value
BRIDGED_GAPS = f"only up to {BRIDGE:g} s, and where the channel is smooth around the gap"
"""Words of messages: which gaps are bridged."""


@dataclass(frozen=True)
class ChannelHole:
    """A gap of a channel."""

    channel: str
    start: float  # time of the last sample before the gap [s]
    length: float  # [s]


class Filled(NamedTuple):
    """A channel at other times, and its gaps of more than `GAP` steps."""

    values: Array  # (m,)
    bridged: tuple[ChannelHole, ...] = ()
    left_open: tuple[ChannelHole, ...] = ()


def fill(channel: str, t: Array, x: Array, times: Array) -> Filled:
    """Interpolate a channel linearly at other, ascending ``times`` [s] (m,).

    The samples ``x`` (n,) at the ascending times ``t`` [s] (n,) are finite. The result is NaN
    outside of them and in a gap that stays open. An event within a bridged gap is lost.
    """
    values: Array = np.interp(times, t, x)
    values[(times < t[0]) | (times > t[-1])] = np.nan
    if t.size < 2:
        return Filled(values)
    step, steps, tolerance = step_of(t), np.diff(t), _SMOOTH * float(np.ptp(x))
    bridged, left_open = [], []
    for i in np.flatnonzero(steps > GAP * step):
        inside = slice(np.searchsorted(times, t[i], side="right"), np.searchsorted(times, t[i + 1]))
        if inside.start == inside.stop:
            continue
        gap = ChannelHole(channel, float(t[i]), float(steps[i]))
        is_short = gap.length <= BRIDGE * (1.0 + 1e-6)  # one of exactly `BRIDGE` despite rounding
        if is_short and _is_smooth(t, x, int(i), step, tolerance):
            bridged.append(gap)
        else:
            left_open.append(gap)
            values[inside] = np.nan
    return Filled(values, tuple(bridged), tuple(left_open))


def fill_rows(
    channels: Mapping[str, Array], time: Array
) -> tuple[dict[str, Array], list[str], list[ChannelHole]]:
    """Fill the rows in which a channel (n,) is NaN, as `fill` does; ``time`` is in s, (n,).

    Return the channels, notes and the bridged gaps. A channel with an infinite value or fewer than
    two values is not changed; if the times do not increase, no channel is.
    """
    values, notes, bridged = dict(channels), [], list[ChannelHole]()
    if not is_ascending(time):
        return values, [], []
    for name, x in channels.items():
        empty = np.isnan(x)
        if not empty.any() or np.count_nonzero(~empty) < 2 or np.isinf(x).any():
            continue
        filled = fill(name, time[~empty], x[~empty], time)
        values[name] = filled.values
        bridged += filled.bridged
        if count := np.count_nonzero(empty & ~np.isnan(filled.values)):
            rows = f"{name}: {count} of {time.size} rows have no value"
            first = f"the first at {time[int(np.argmax(empty))]:.3f} s"
            notes.append(f"{rows} and were interpolated, {first}")
        notes += in_words(filled)
    return values, notes, bridged


def in_words(filled: Filled) -> list[str]:
    """Write notes on the gaps of a channel: one on those bridged, one on those left open."""
    notes = []
    for gaps, result in (
        (filled.bridged, "bridged with a straight line"),
        (filled.left_open, f"not bridged, which is done {BRIDGED_GAPS}"),
    ):
        if longest := max(gaps, key=lambda gap: gap.length, default=None):
            place = f"the longest of {longest.length:.3f} s at {longest.start:.3f} s"
            notes.append(f"{longest.channel}: {counted(len(gaps), 'gap')} {result}, {place}")
    return notes


def _is_smooth(t: Array, x: Array, i: int, step: float, tolerance: float) -> bool:
    """Whether the gap after sample ``i`` has straight sides that meet in the middle.

    ``t`` [s] and ``x`` are (n,), ``step`` is the mean step [s]. The sides may be off by the noise
    and ``tolerance`` [unit of ``x``].
    """
    reach = max(_SIDE, float(t[i + 1] - t[i]), (_FEWEST + 0.5) * step)
    first, end = np.searchsorted(t, [t[i] - reach, t[i + 1] + reach])
    sides = slice(first, i + 1), slice(i + 1, end)
    if min(side.stop - side.start for side in sides) < _FEWEST:
        return False
    near = slice(*np.searchsorted(t, [t[i] - _NEAR, t[i + 1] + _NEAR]))
    noise = _noise(t[near], x[near])
    t_middle, x_middle = 0.5 * (t[i] + t[i + 1]), 0.5 * (x[i] + x[i + 1])
    return all(_leads_to_origin(t[s] - t_middle, x[s] - x_middle, noise, tolerance) for s in sides)


def _noise(t: Array, x: Array) -> float:
    """Standard deviation of the noise of samples ``x`` (k,) at uneven times ``t`` [s] (k,).

    The distance of a sample from the line through its two neighbours has 1.5 times the variance of
    the noise. The 0.8 quantile of normal distances is 1.2816 sigma. Unlike the mean square it
    ignores a few steps, and unlike the median it is not 0 for noise that is cut off at zero.
    """
    weight = (t[1:-1] - t[:-2]) / (t[2:] - t[:-2])
    distance = x[1:-1] - (1.0 - weight) * x[:-2] - weight * x[2:]
    return float(np.quantile(np.abs(distance), 0.8) / 1.2816 / np.sqrt(1.5))


def _leads_to_origin(t: Array, x: Array, noise: float, tolerance: float) -> bool:
    """Whether the samples of a side (k,) lie on a line that goes through the origin.

    The origin is the mean of the two samples beside the gap, so its variance is 0.5 ``noise``^2.
    """
    t_mean, x_mean = float(t.mean()), float(x.mean())
    spread = float(np.sum((t - t_mean) ** 2))
    if spread < INSTANT**2:
        return False
    slope = float(np.sum((t - t_mean) * x)) / spread
    residual = float(np.abs(x - x_mean - slope * (t - t_mean)).max())
    at_origin = x_mean - slope * t_mean
    sigma = noise * float(np.sqrt(1.0 / t.size + t_mean**2 / spread + 0.5))
    # white noise exceeds 3 sigma once in 370 values; 4 are for the largest of many residuals
    is_straight = residual <= tolerance + 4.0 * noise
    return is_straight and abs(at_origin) <= tolerance + 3.0 * sigma


def without_open_ends(channels: dict[str, Array]) -> tuple[dict[str, Array], tuple[str, ...]]:
    """Cut off gaps up to `ENDS` long at the ends of the log; return the channels and a note."""
    time = channels["time"]
    if not np.isfinite(time).all():
        return channels, ()
    begin, end, trimmed = 0, time.size, list[str]()
    for name, values in channels.items():
        empty = np.isnan(values)
        if name not in CHANNELS or not empty.any() or empty.all():
            continue
        first, last = np.flatnonzero(~empty)[[0, -1]]  # first and last row with a value
        are_short = time[first] - time[0] <= ENDS and time[-1] - time[last] <= ENDS
        if are_short and (first > 0 or last + 1 < time.size):
            trimmed.append(name)
            begin, end = max(begin, int(first)), min(end, int(last) + 1)
    if not trimmed or begin >= end:
        return channels, ()
    rows = f"the first {begin} and the last {time.size - end} rows"
    note = f"{', '.join(trimmed)}: no value at the start or the end; {rows} were left out"
    return {name: values[begin:end] for name, values in channels.items()}, (note,)


def complete_channels(
    channels: dict[str, Array], require: tuple[str, ...], where: str
) -> tuple[dict[str, Array], tuple[str, ...]]:
    """Return the channels that are finite in every row, and a note on each of the others.

    Raises LogError for a channel in ``require`` without any value, and for a gap in a channel that
    every log must have.
    """
    complete, notes = {}, []
    if np.isinf(channels["time"]).any():  # a flaw of the clock, not a gap
        check_increasing(channels["time"], where)
    for name, values in channels.items():
        bad = np.flatnonzero(~np.isfinite(values))
        if not bad.size:
            complete[name] = values
        elif np.isnan(values).all():
            if name in require:
                flaw = f"the channel is empty: no value in {values.size} rows"
                expected = "a value in every row"
                do = "run `brake-cal check`: it lists the remaining uses of the log"
                raise LogError(flaw, where=f"{where}: {name}", expected=expected, do=do)
            notes.append(f"{name} is empty and was left out")
        else:
            kind = "no" if np.isnan(values[bad[0]]) else "an infinite"
            flaw = f"{kind} value in {bad.size} of {values.size} rows, first in row {bad[0] + 1}"
            if name in CHANNELS and CHANNELS[name].required:
                start = channels["time"][bad[0]] - channels["time"][0]
                after = f", {start:.3f} s after the start" if np.isfinite(start) else ""
                expected = "a finite value in every row"
                bridged = f"a gap is bridged {BRIDGED_GAPS}"
                do = f"export all channels on one clock, or cut the log: {bridged}"
                raise LogError(f"{flaw}{after}", where=f"{where}: {name}", expected=expected, do=do)
            notes.append(f"{name} has {flaw}, and was left out")
    return complete, tuple(notes)

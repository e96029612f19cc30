"""Bridge the short gaps of a channel, such as that of a lost CAN message.

. . . .------. . . .    both sides lead to the middle of the bridge: smooth, bridged

             . . . .
. . . .                 they do not: something happened in the gap, it stays open
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

BRIDGE = 0.2
"""Gaps longer than this [s] and than `GAP` are never bridged: a brake builds up in that time."""
_SIDE = 0.1
"""Length [s] of the samples on either side of a gap that show whether a channel is smooth."""
_NEAR = 0.5  # length [s] of the samples on either side of a gap that show the noise
_FEWEST = 4  # fewest samples of a side: nearly every line goes through fewer
INSTANT = 1e-9
"""Samples within this time [s] show no slope: recorders count no finer than nanoseconds, and only
damaged times are nearer."""
_SMOOTH = 0.01  # largest error of a bridge beside the noise, over the range of the channel [1]
ENDS = 1.0
"""Longest time [s] at the start or the end of a log for which a channel may have no value."""
ONLY = f"only up to {BRIDGE:g} s, and where the channel is smooth around the gap"
"""Which gaps are bridged, in words."""


@dataclass(frozen=True)
class ChannelHole:
    """A gap of ``channel``: its last sample before it, ``start`` [s], and its ``length`` [s]."""

    channel: str
    start: float
    length: float


class Filled(NamedTuple):
    """``values`` at the wanted times, and the gaps of over `GAP` steps within them."""

    values: Array
    bridged: tuple[ChannelHole, ...] = ()
    left_open: tuple[ChannelHole, ...] = ()


def fill(channel: str, t: Array, x: Array, times: Array) -> Filled:
    """Values of a channel at other ``times`` [s], (m,), on straight lines between its samples.

    ``t`` [s] ascends, ``x`` (n,) has no NaN. The result is NaN before the first sample, after the
    last, and in a gap that stays open. A bridge hides what begins and ends within its gap.
    """
    values: Array = np.interp(times, t, x)
    values[(times < t[0]) | (times > t[-1])] = np.nan
    if t.size < 2:
        return Filled(values)
    step, steps, allowed = step_of(t), np.diff(t), _SMOOTH * float(np.ptp(x))
    bridged, left_open = [], []
    for i in np.flatnonzero(steps > GAP * step):
        inside = slice(np.searchsorted(times, t[i], side="right"), np.searchsorted(times, t[i + 1]))
        if inside.start == inside.stop:
            continue  # no value is wanted there
        gap = ChannelHole(channel, float(t[i]), float(steps[i]))
        if gap.length <= BRIDGE * (1.0 + 1e-6) and _smooth(t, x, int(i), step, allowed):
            bridged.append(gap)
        else:
            left_open.append(gap)
            values[inside] = np.nan
    return Filled(values, tuple(bridged), tuple(left_open))


def fill_rows(
    channels: Mapping[str, Array], time: Array
) -> tuple[dict[str, Array], list[str], list[ChannelHole]]:
    """Fill the rows (n,) in which a channel is NaN, as `fill` does; ``time`` in s.

    Returns channels, notes and bridged gaps. Channels with infinite values or fewer than two stay
    as they are; all do if the times do not increase.
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
            notes.append(
                f"{name}: {count} of {time.size} rows have no value and were interpolated, "
                f"the first at {time[int(np.argmax(empty))]:.3f} s"
            )
        notes += in_words(filled)
    return values, notes, bridged


def in_words(filled: Filled) -> list[str]:
    """Notes on the gaps of a channel that were bridged and left open; empty if there are none."""
    notes = []
    for gaps, result in (
        (filled.bridged, "bridged with a straight line"),
        (filled.left_open, f"not bridged, which is done {ONLY}"),
    ):
        if longest := max(gaps, key=lambda gap: gap.length, default=None):
            place = f"the longest of {longest.length:.3f} s at {longest.start:.3f} s"
            notes.append(f"{longest.channel}: {counted(len(gaps), 'gap')} {result}, {place}")
    return notes


def _smooth(t: Array, x: Array, i: int, step: float, allowed: float) -> bool:
    """Whether both sides of gap ``i`` are straight and lead to the middle of its bridge.

    ``allowed`` error of the bridge beside the noise, in the unit of ``x``.
    """
    reach = max(_SIDE, float(t[i + 1] - t[i]), (_FEWEST + 0.5) * step)
    first, end = np.searchsorted(t, [t[i] - reach, t[i + 1] + reach])
    sides = slice(first, i + 1), slice(i + 1, end)
    if min(side.stop - side.start for side in sides) < _FEWEST:
        return False
    wide = slice(*np.searchsorted(t, [t[i] - _NEAR, t[i + 1] + _NEAR]))
    t_wide, x_wide = t[wide], x[wide]
    weight = (t_wide[1:-1] - t_wide[:-2]) / (t_wide[2:] - t_wide[:-2])
    bends = x_wide[1:-1] - (1.0 - weight) * x_wide[:-2] - weight * x_wide[2:]
    # a few bends do not count; the median is 0 for noise that is cut off at zero
    noise = float(np.quantile(np.abs(bends), 0.8) / 1.2816 / np.sqrt(1.5))
    centre, middle = 0.5 * (t[i] + t[i + 1]), 0.5 * (x[i] + x[i + 1])
    return all(_leads_to(t[s] - centre, x[s] - middle, noise, allowed) for s in sides)


def _leads_to(t: Array, x: Array, noise: float, allowed: float) -> bool:
    """Whether the samples of a side lie on a line that goes through the origin."""
    centre, mean = float(t.mean()), float(x.mean())
    spread = float(np.sum((t - centre) ** 2))
    if spread < INSTANT**2:
        return False
    slope = float(np.sum((t - centre) * x)) / spread
    bend = float(np.abs(x - mean - slope * (t - centre)).max())
    sigma = noise * float(np.sqrt(1.0 / t.size + centre**2 / spread + 0.5))  # 0.5 of its ends
    straight = bend <= allowed + 4.0 * noise
    return straight and abs(mean - slope * centre) <= allowed + 3.0 * sigma


def without_open_ends(channels: dict[str, Array]) -> tuple[dict[str, Array], tuple[str, ...]]:
    """The rows (m,) of ``channels`` (n,) in which all have begun and none has ended, and a note.

    A channel without a value for more than `ENDS` [s] at an end counts as one with a gap.
    """
    time = channels["time"]
    begin, end, trimmed = 0, time.size, list[str]()
    for name, values in channels.items() if np.isfinite(time).all() else ():
        empty = np.isnan(values)
        if name not in CHANNELS or not empty.any() or empty.all():
            continue
        first, last = int(np.argmin(empty)), values.size - 1 - int(np.argmin(empty[::-1]))
        short = time[first] - time[0] <= ENDS and time[-1] - time[last] <= ENDS
        if short and (first > 0 or last + 1 < time.size):
            trimmed.append(name)
            begin, end = max(begin, first), min(end, last + 1)
    if not trimmed or begin >= end:
        return channels, ()
    note = (
        f"{', '.join(trimmed)}: no value at the start or the end; "
        f"the first {begin} and the last {time.size - end} rows were left out"
    )
    return {name: values[begin:end] for name, values in channels.items()}, (note,)


def complete_channels(
    channels: dict[str, Array], require: tuple[str, ...], where: str
) -> tuple[dict[str, Array], tuple[str, ...]]:
    """The channels that are finite in every row, and a note on each dropped one.

    Raises LogError for an empty channel in ``require``, and for a gap in one that every log has.
    """
    complete, notes = {}, []
    if np.isinf(channels["time"]).any():
        check_increasing(channels["time"], where)
    for name, values in channels.items():
        bad = np.flatnonzero(~np.isfinite(values))
        if not bad.size:
            complete[name] = values
        elif np.isnan(values).all():
            if name in require:
                raise LogError(
                    f"the channel is empty: no value in {values.size} rows",
                    where=f"{where}: {name}",
                    expected="a value in every row",
                    do="run `brake-cal check`: it lists the remaining uses of the log",
                )
            notes.append(f"{name} is empty and was left out")
        else:
            kind = "no" if np.isnan(values[bad[0]]) else "an infinite"
            flaw = f"{kind} value in {bad.size} of {values.size} rows, first in row {bad[0] + 1}"
            if name in CHANNELS and CHANNELS[name].required:
                start = channels["time"][bad[0]] - channels["time"][0]
                raise LogError(
                    f"{flaw}, {start:.3f} s after the start",
                    where=f"{where}: {name}",
                    expected="a finite value in every row",
                    do="export all channels on one clock, or cut the log before the gap: a gap is "
                    f"bridged {ONLY}",
                )
            notes.append(f"{name} has {flaw}, and was left out")
    return complete, tuple(notes)

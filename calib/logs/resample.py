"""Resample channels with several sample rates onto one clock.

p_mc     |.........|.........|....        100 Hz   linear between its samples
omega    ....|....|....|....|....          200 Hz   the clock: kept as it is
v        .........|...................      10 Hz   linear
time         |----|----|----|              only where all required channels have values
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import chain

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.names import CHANNELS, FLAGS
from calib.logs.clock import check_running, is_ascending, on_line, step_of
from calib.logs.gaps import INSTANT, ChannelHole, Filled, fill, fill_rows, in_words
from calib.logs.source import ChannelTrace

_FASTEST = 1050.0  # a sample rate above this [Hz] is not used as the clock if there is a slower one
_ALIKE = 0.9
"""From this share of the highest rate on, the clock with most wheel speeds is chosen [1]."""
_UNEVEN = 0.5
"""Largest difference of nine tenths of the steps of an even clock from their median [1]."""
_ENDS = 0.5  # an optional channel may shorten the log by at most this at either end [s]


@dataclass(frozen=True)
class Resampled:
    """Channels on one clock [s]: values (n,), NaN for none, and original rates by name [Hz].

    ``interpolated`` are the names of those that were recorded on another clock.
    """

    time: Array
    values: list[Array]
    notes: tuple[str, ...]
    bridged: tuple[ChannelHole, ...]
    rates: dict[str, float] = field(default_factory=dict)
    interpolated: tuple[str, ...] = ()


def rows_on_one_clock(time: Array, columns: Mapping[str, Array], where: str) -> Resampled:
    """The columns (n,) of a table with rows at ``time`` [s] (n,): short gaps are bridged.

    Rows of several clocks are resampled as by `on_one_clock`.
    """
    if not _of_several_clocks(time, columns):
        time, rounded = on_line(time) if is_ascending(time) else (time, ())
        filled, notes, bridged = fill_rows(columns, time)
        return Resampled(time, [*filled.values()], (*rounded, *notes), tuple(bridged))
    clocks: dict[bytes, str] = {}
    traces = []
    for name, x in columns.items():
        present = ~np.isnan(x)
        clock = clocks.setdefault(present.tobytes(), f"rows of {name}")
        traces.append(ChannelTrace(clock, time[present], x[present], name in FLAGS, name))
    note = "the rows are those of several clocks: each channel was put on one clock"
    resampled = on_one_clock(traces, where)
    return replace(resampled, notes=(note, *resampled.notes))


def _of_several_clocks(time: Array, columns: Mapping[str, Array]) -> bool:
    """Whether rows at ``time`` [s] (n,) come from several clocks, one row for each time stamp.

    The rows are uneven then, and the values of a column (n,), NaN for none, have even times.
    Required channels decide, or all columns where none is required.
    """
    if time.size < 3 or not is_ascending(time) or _even(time):
        return False
    required = [x for name, x in columns.items() if name in CHANNELS and CHANNELS[name].required]
    masks = [np.isfinite(x) for x in (required or columns.values())]
    return any(3 <= np.count_nonzero(k) < k.size and _even(time[k]) for k in masks)


def on_one_clock(wanted: Sequence[ChannelTrace], where: str) -> Resampled:
    """Resample channels onto the clock of the required one with the highest rate and even steps.

    Of clocks about as fast the one with most wheel speeds is chosen. Other channels are
    interpolated, states hold their last value; they are NaN outside their samples and in a gap,
    unless `calib.logs.gaps` bridges it. Columns that are no channel count only where there is no
    channel. Raises LogError if the required channels have no time in common, and for times out of
    order.
    """
    if not wanted:
        raise LogError("no channel is known", where=where, do="name channels in a channel map")
    wanted, notes = _clean(wanted, where)
    full = [w for w in wanted if w.time.size > 1]
    if not full:
        raise LogError("every channel is empty", where=where, expected="samples")
    channels = [w for w in full if w.name in CHANNELS] or full
    low, high, cut = _span(channels, where)
    rasters = {(w.clock, w.time.size): w.time for w in full}
    rate_of = {key: 1.0 / max(step_of(time), INSTANT) for key, time in rasters.items()}
    rates = {w.name: rate_of[w.clock, w.time.size] for w in full}
    master = _master(channels, rates)
    time = master.time[(master.time >= low) & (master.time <= high)]
    filled = [_on(w, time) for w in wanted]
    names = {w.name for w in channels}
    gaps = [in_words(x) for w, x in zip(wanted, filled, strict=True) if w.name in names]
    return Resampled(
        time,
        [item.values for item in filled],
        (*notes, *_notes(channels, master, rates), *chain(*gaps), *cut),
        tuple(gap for item in filled for gap in item.bridged),
        rates,
        tuple(w.name for w in full if not (w.state or np.array_equal(w.time, master.time))),
    )


def _clean(wanted: Sequence[ChannelTrace], where: str) -> tuple[list[ChannelTrace], list[str]]:
    clocks: dict[str, Array] = {}
    notes: list[str] = []
    cleaned = []
    for w in wanted:
        clock = w.clock
        if clock not in clocks:
            time = w.time.astype(np.float64)
            check_running(time, f"{where}: {clock}")
            if np.all(np.diff(time) > 0):
                time, rounded = on_line(time)
                notes += [f"{clock}: {text}" for text in rounded]
            clocks[clock] = time
        trace = _ordered(w, clocks[clock])
        cleaned.append(trace)
        if invalid := int(np.count_nonzero(np.isnan(w.values))):
            notes.append(f"{w.name}: {invalid} samples are marked invalid and were left out")
        if twice := w.time.size - invalid - trace.time.size:
            notes.append(f"{clock}: {twice} samples repeat a time; the last was used")
    return cleaned, list(dict.fromkeys(notes))


def _ordered(trace: ChannelTrace, time: Array) -> ChannelTrace:
    """The valid values at ascending times; of equal times the last one in the file."""
    valid = ~np.isnan(trace.values)
    if np.all(np.diff(time) > 0) and valid.all():
        return replace(trace, time=time)
    order = np.argsort(time[valid], kind="stable")
    t, x = time[valid][order], trace.values[valid][order]
    last = np.append(np.diff(t) > 0, True) if t.size else np.zeros(0, bool)
    return replace(trace, time=t[last], values=x[last])


def _required(full: list[ChannelTrace]) -> list[ChannelTrace]:
    return [w for w in full if w.name in CHANNELS and CHANNELS[w.name].required] or full


def _span(full: list[ChannelTrace], where: str) -> tuple[float, float, list[str]]:
    """First and last time of all required channels [s], with a note on cut ends.

    Other channels may shorten it by `_ENDS` at either end.
    """
    base = _required(full)
    low = max(float(w.time[0]) for w in base)
    high = min(float(w.time[-1]) for w in base)
    if high <= low:
        spans = (f"{w.name} {w.time[0]:.3f} to {w.time[-1]:.3f} s" for w in base)
        raise LogError(
            "the channels have no time in common: " + ", ".join(spans),
            where=where,
            expected="one run in which all are recorded",
        )
    first, last = min(w.time[0] for w in full), max(w.time[-1] for w in full)
    # shorter ones get NaN
    near = [w for w in full if w.time[0] <= low + _ENDS and w.time[-1] >= high - _ENDS]
    low = max([low, *(float(w.time[0]) for w in near)])
    high = min([high, *(float(w.time[-1]) for w in near)])
    ends = max(low - first, last - high)
    cut = f"{low - first:.3f} s at the start and {last - high:.3f} s at the end were cut off: "
    return low, high, [cut + "not every channel has values there"] if ends > 0.0005 else []


def _even(time: Array) -> bool:
    """Whether nearly all steps are about as long, unlike those of a multiplexed message."""
    steps = np.diff(time)
    median = float(np.median(steps))
    return bool(np.quantile(np.abs(steps - median), 0.9) <= _UNEVEN * median)


def _master(full: list[ChannelTrace], rates: dict[str, float]) -> ChannelTrace:
    base = _required(full)
    base = [w for w in base if _even(w.time)] or base
    fastest = [rates[w.name] for w in base]
    top = max([r for r in fastest if r <= _FASTEST] or fastest)
    alike = [w for w in base if _ALIKE * top <= rates[w.name] <= top]

    def preference(w: ChannelTrace) -> tuple[int, int, int]:
        names = [x.name for x in full if x.clock == w.clock]
        return sum(n.startswith("omega") for n in names), len(names), w.time.size

    return max(alike, key=preference)


def _on(w: ChannelTrace, times: Array) -> Filled:
    t, x = w.time, w.values
    if t.size < 2:
        return Filled(np.full(times.size, np.nan))
    if not w.state:
        return fill(w.name, t, x, times)
    rows = np.clip(np.searchsorted(t, times, side="right") - 1, 0, t.size - 1)
    values: Array = x[rows].astype(np.float64)
    values[(times < t[0]) | (times > t[-1])] = np.nan
    return Filled(values)


def _notes(full: list[ChannelTrace], master: ChannelTrace, rates: dict[str, float]) -> list[str]:
    on_it = [np.array_equal(w.time, master.time) for w in full]
    lines: dict[str, list[str]] = {}
    for w, is_clock in zip(full, on_it, strict=True):
        how = "is the clock" if is_clock else "held" if w.state else "interpolated linearly"
        lines.setdefault(f"({w.clock}, {rates[w.name]:.4g} Hz) {how}", []).append(w.name)
    notes = [f"{', '.join(names)} {how}" for how, names in lines.items()]
    return [] if all(on_it) else notes

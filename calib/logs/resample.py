"""Put channels with several sample rates on one clock.

p_mc     |.........|.........|....        100 Hz   linear between its samples
omega    ....|....|....|....|....          200 Hz   the clock: kept as it is
v        .........|...................      10 Hz   linear
result       |----|----|----|              only where all required channels have values
"""

from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.base.names import CHANNELS, FLAGS
from calib.logs.clock import check_running, is_ascending, on_line, step_of
from calib.logs.gaps import INSTANT, ChannelHole, Filled, fill, fill_rows, in_words
from calib.logs.source import ChannelTrace

_FASTEST = 1050.0  # a rate above this [Hz] is used as the clock only if no channel is slower
_ALIKE = 0.9  # clocks with at least this share of the highest rate [1] count as equally fast
_UNEVEN = 0.5  # nine of ten steps of an even clock are within this share of their median [1]
_CUT = 0.5  # longest time [s] that an optional channel may cut off at either end of the log
_NO_CUT = 0.0005  # longest time [s] that is cut off without a note: clocks count in milliseconds


@dataclass(frozen=True)
class Resampled:
    """Channels on one clock, in the order in which they were given."""

    time: Array  # [s] (n,)
    values: list[Array]  # (n,) for each channel, NaN for no value
    notes: tuple[str, ...]
    bridged: tuple[ChannelHole, ...]
    rates: dict[str, float] = field(default_factory=dict)  # [Hz], as recorded, by channel
    interpolated: tuple[str, ...] = ()  # channels that had another clock


def rows_on_one_clock(time: Array, columns: Mapping[str, Array], where: str) -> Resampled:
    """Put the columns (n,) of a table with rows at ``time`` [s] (n,) on one clock.

    If the rows already have one clock, only short gaps are bridged. If a program merged the rows of
    several clocks, `on_one_clock` resamples them.
    """
    if not _have_several_clocks(time, columns):
        time, clock_notes = on_line(time) if is_ascending(time) else (time, ())
        filled, notes, bridged = fill_rows(columns, time)
        return Resampled(time, [*filled.values()], (*clock_notes, *notes), tuple(bridged))
    clocks: dict[bytes, str] = {}
    traces = []
    for name, x in columns.items():
        present = ~np.isnan(x)
        # columns with values in the same rows have one clock, which is named after the first
        clock = clocks.setdefault(present.tobytes(), f"rows of {name}")
        is_state = name in FLAGS
        traces.append(ChannelTrace(clock, time[present], x[present], is_state, name))
    note = "the rows are those of several clocks: each channel was put on one clock"
    resampled = on_one_clock(traces, where)
    return replace(resampled, notes=(note, *resampled.notes))


def _have_several_clocks(time: Array, columns: Mapping[str, Array]) -> bool:
    """Whether the rows at ``time`` [s] (n,) are those of several clocks, merged.

    Then the times of all rows together are uneven, while the times of the rows with values of one
    required channel (or of one column, if none is required) are even.
    """
    if time.size < 3 or not is_ascending(time) or _is_even(time):
        return False
    masks = [np.isfinite(columns[name]) for name in _required_or_all(columns)]
    return any(3 <= np.count_nonzero(mask) < mask.size and _is_even(time[mask]) for mask in masks)


def on_one_clock(traces: Sequence[ChannelTrace], where: str) -> Resampled:
    """Put channels on the clock of the fastest required channel with even steps.

    Of clocks that are equally fast the one with most wheel speeds is taken. Other channels are
    interpolated linearly, states hold their last value. A channel is NaN outside its samples, and
    in a gap that `calib.logs.gaps` leaves open. Columns that are no channels have no influence on
    the clock unless there are only such columns. Raises LogError if the required channels have no
    time in common, and for times out of order.
    """
    if not traces:
        raise LogError("no channel is known", where=where, do="name channels in a channel map")
    traces, notes = _cleaned(traces, where)
    sampled = [trace for trace in traces if trace.time.size > 1]
    if not sampled:
        raise LogError("every channel is empty", where=where, expected="samples")
    channels = [trace for trace in sampled if trace.name in CHANNELS] or sampled
    required_names = _required_or_all([trace.name for trace in channels])
    required = [trace for trace in channels if trace.name in required_names]
    low, high, cut_note = _span(channels, required, where)
    rates = _rates(sampled)
    master = _master(channels, required, rates)
    time = master.time[(master.time >= low) & (master.time <= high)]
    filled = [_at_times(time, trace) for trace in traces]
    notes += _notes(channels, master, rates)
    names = {trace.name for trace in channels}
    for trace, item in zip(traces, filled, strict=True):
        notes += in_words(item) if trace.name in names else []
    on_other_clock = [x for x in sampled if not np.array_equal(x.time, master.time)]
    return Resampled(
        time,
        values=[item.values for item in filled],
        notes=(*notes, *cut_note),
        bridged=tuple(gap for item in filled for gap in item.bridged),
        rates=rates,
        interpolated=tuple(x.name for x in on_other_clock if not x.is_state),
    )


def _rates(traces: list[ChannelTrace]) -> dict[str, float]:
    """Sample rate [Hz] of each channel, by name."""
    # traces of one clock with equally many samples have the same times, whose rate is found once
    times = {(trace.clock, trace.time.size): trace.time for trace in traces}
    by_times = {key: 1.0 / max(step_of(time), INSTANT) for key, time in times.items()}
    return {trace.name: by_times[trace.clock, trace.time.size] for trace in traces}


def _cleaned(traces: Sequence[ChannelTrace], where: str) -> tuple[list[ChannelTrace], list[str]]:
    """Return traces of valid samples at ascending times, and notes on what was left out."""
    clocks, notes, cleaned = dict[str, Array](), list[str](), []
    for trace in traces:
        clock = trace.clock
        if clock not in clocks:
            time = trace.time.astype(np.float64)
            check_running(time, f"{where}: {clock}")
            if np.all(np.diff(time) > 0):
                time, clock_notes = on_line(time)
                notes += [f"{clock}: {text}" for text in clock_notes]
            clocks[clock] = time
        ordered = _ordered(trace, clocks[clock])
        cleaned.append(ordered)
        if invalid := int(np.count_nonzero(np.isnan(trace.values))):
            notes.append(f"{trace.name}: {invalid} samples are marked invalid and were left out")
        if repeated := trace.time.size - invalid - ordered.time.size:
            notes.append(f"{clock}: {repeated} samples repeat a time; the last was used")
    return cleaned, list(dict.fromkeys(notes))


def _ordered(trace: ChannelTrace, time: Array) -> ChannelTrace:
    """Sort the valid samples by ``time`` [s] (n,); of equal times keep the last in the file."""
    valid = ~np.isnan(trace.values)
    if np.all(np.diff(time) > 0) and valid.all():
        return replace(trace, time=time)
    order = np.argsort(time[valid], kind="stable")
    t, x = time[valid][order], trace.values[valid][order]
    is_last = np.append(np.diff(t) > 0, True) if t.size else np.zeros(0, bool)
    return replace(trace, time=t[is_last], values=x[is_last])


def _required_or_all(names: Iterable[str]) -> list[str]:
    """Return the names of required channels, or all names if there is none."""
    required = [name for name in names if name in CHANNELS and CHANNELS[name].required]
    return required or list(names)


def _span(
    channels: list[ChannelTrace], required: list[ChannelTrace], where: str
) -> tuple[float, float, list[str]]:
    """Return first and last time [s] that all required channels share, and a note on cut ends.

    Optional channels that are at most `_CUT` shorter at either end shorten this span. Others do
    not: they become NaN at the ends.
    """
    low = max(float(x.time[0]) for x in required)
    high = min(float(x.time[-1]) for x in required)
    if high <= low:
        spans = (f"{x.name} {x.time[0]:.3f} to {x.time[-1]:.3f} s" for x in required)
        flaw = f"the channels have no time in common: {', '.join(spans)}"
        raise LogError(flaw, where=where, expected="one run in which all are recorded")
    first, last = min(x.time[0] for x in channels), max(x.time[-1] for x in channels)
    cutting = [x for x in channels if x.time[0] <= low + _CUT and x.time[-1] >= high - _CUT]
    low = max([low, *(float(x.time[0]) for x in cutting)])
    high = min([high, *(float(x.time[-1]) for x in cutting)])
    if max(low - first, last - high) <= _NO_CUT:
        return low, high, []
    cut = f"{low - first:.3f} s at the start and {last - high:.3f} s at the end were cut off"
    return low, high, [f"{cut}: not every channel has values there"]


def _is_even(time: Array) -> bool:
    """Whether nine of ten steps are alike, which those of a multiplexed message are not."""
    steps = np.diff(time)
    median = float(np.median(steps))
    return bool(np.quantile(np.abs(steps - median), 0.9) <= _UNEVEN * median)


def _master(
    channels: list[ChannelTrace], required: list[ChannelTrace], rates: dict[str, float]
) -> ChannelTrace:
    """Return the required channel whose times become the clock."""
    candidates = [x for x in required if _is_even(x.time)] or required
    all_rates = [rates[x.name] for x in candidates]
    highest = max([rate for rate in all_rates if rate <= _FASTEST] or all_rates)
    alike = [x for x in candidates if _ALIKE * highest <= rates[x.name] <= highest]

    def preference(candidate: ChannelTrace) -> tuple[int, int, int]:
        names = [x.name for x in channels if x.clock == candidate.clock]
        wheels = sum(name.startswith("omega") for name in names)
        return wheels, len(names), candidate.time.size

    return max(alike, key=preference)


def _at_times(times: Array, trace: ChannelTrace) -> Filled:
    """Values of a channel at ``times`` [s] (n,): interpolated, or held if it is a state."""
    t, x = trace.time, trace.values
    if t.size < 2:
        return Filled(np.full(times.size, np.nan))
    if not trace.is_state:
        return fill(trace.name, t, x, times)
    rows = np.clip(np.searchsorted(t, times, side="right") - 1, 0, t.size - 1)
    values: Array = x[rows].astype(np.float64)
    values[(times < t[0]) | (times > t[-1])] = np.nan
    return Filled(values)


def _notes(
    channels: list[ChannelTrace], master: ChannelTrace, rates: dict[str, float]
) -> list[str]:
    """Write a note for each group of channels: whether it is the clock, held or interpolated."""
    has_clock = [np.array_equal(x.time, master.time) for x in channels]
    if all(has_clock):
        return []
    groups: dict[str, list[str]] = {}
    for x, is_clock in zip(channels, has_clock, strict=True):
        how = "is the clock" if is_clock else "held" if x.is_state else "interpolated linearly"
        groups.setdefault(f"({x.clock}, {rates[x.name]:.4g} Hz) {how}", []).append(x.name)
    return [f"{', '.join(names)} {how}" for how, names in groups.items()]

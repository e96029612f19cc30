"""Channels that are no independent measurement: copies, derivatives, values that are held.

Two sensors have independent noise; two copies share it. A bus sends GPS at 10 Hz, a_x and wheels at
50 or 100 Hz, and a faster logger repeats the last value: steps, late by half a step on average.
Such a channel is interpolated between the samples at which its values came. The delay of the
message itself is left to `speed_delay`.
"""

from collections.abc import Iterator, Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np

from calib.base.arrays import Array, Index
from calib.base.names import WHEEL_SPEEDS
from calib.base.warning import LIMITS, bounds_of
from calib.logs.clock import GAP
from calib.logs.log import Log
from calib.run.filters import inner_products, residual_squares
from calib.run.sensors import resolution_of

_WIDEST, _MOST_LAGS = 0.15, 40  # reach of a derivative [s], and at most [samples]
_ONE_SIGNAL = bounds_of("same_signal")[1]
_ENOUGH = 4000  # samples that are used
_HELD = 1.5  # mean samples per value from which a channel is held


def shares_of_speed(log: Log) -> Iterator[tuple[str, float]]:
    """Share of the noise of a_x that v, or the mean wheel speed, explains [1].

    A derivative is a weighted sum of nearby values of the speed, which explain all of its noise,
    and none of that of an accelerometer.
    """
    if not _is_noise(log, "a_x"):
        return  # smooth, as of a simulation
    reach = min(max(2, round(_WIDEST / log.sample_time)), _MOST_LAGS)
    wheels = np.mean([log[name] for name in WHEEL_SPEEDS], axis=0)
    speeds = {"v": log["v"]} if "v" in log else {}
    a_x = np.diff(log["a_x"][:_ENOUGH], 2)
    for name, speed in {**speeds, "the wheel speeds": wheels}.items():
        x, n = np.diff(speed[:_ENOUGH], 2), a_x.size - 2 * reach
        count = 2 * reach + 1
        if n < 4 * count or not (np.any(x) and np.any(a_x)):
            continue
        A = np.lib.stride_tricks.sliding_window_view(x, count).T.copy()
        y = a_x[reach : reach + n]
        residual = float(residual_squares(inner_products(A[None], y))[0])
        yield name, 1.0 - n / (n - count) * residual / float(y @ y)


def twice(log: Log, names: Sequence[str]) -> Iterator[tuple[str, str, float]]:
    """Pairs of channels that are copies, each with the correlation of their noise [1]."""
    periods = {name: _period_of(log[name]) for name in names}
    whole = {name: _unit(_rough(log, name)) for name in names}
    for first, other in combinations(names, 2):
        sent, x, y = log, whole[first], whole[other]
        if min(periods[first], periods[other]) >= _HELD:
            came = np.flatnonzero(np.diff(log[first])) + 1  # held channels step together
            sent = replace(log, channels={name: z[came] for name, z in log.channels.items()})
            x, y = (_unit(_rough(sent, name)) for name in (first, other))
        if abs(float(x @ y)) > _ONE_SIGNAL and _is_noise(sent, first):
            far = x**2 + y**2
            calm = far <= np.quantile(far, LIMITS.copy_calmer)  # without a bump
            size = float(np.linalg.norm(x[calm]) * np.linalg.norm(y[calm]))
            same = abs(float(x[calm] @ y[calm])) / size if size > 0.0 else 0.0
            if same > _ONE_SIGNAL:
                yield first, other, same


def _rough(log: Log, channel: str) -> Array:
    """Second differences of a channel, none over a gap: every channel has that alike."""
    even = np.diff(log.time) <= GAP * log.sample_time
    return np.asarray(np.diff(log[channel], 2)[even[1:] & even[:-1]])


def _unit(x: Array) -> Array:
    return x / (float(np.linalg.norm(x)) or 1.0)


def _is_noise(log: Log, channel: str) -> bool:
    """Whether the second differences alternate in sign, as noise does, and exceed the rounding."""
    differences = _rough(log, channel)
    square = float(differences @ differences)
    rounding = LIMITS.copy_steps * resolution_of(log[channel])
    above = square > rounding**2 * differences.size
    return above and float(differences[1:] @ differences[:-1]) < -0.3 * square


_CHANNELS = ("p_mc", "a_x", "v", *WHEEL_SPEEDS)
"""Inputs of a diagnosis."""

_FEWEST = 20  # changes from which a period is estimated
_SOONER = 0.1  # share of the changes that may come sooner than a period: messages jitter
_LATER = 1.6  # longest time between two changes that is one period [periods]: a value was lost
_SAME = 0.6  # a value that stays this much longer was sent once more [periods]
_LONGEST = 0.25  # longest period [s]: a channel that changes less often rests, or is coarse


def _period_of(x: Array) -> float:
    """Samples [1] for which a channel (n,) keeps each value; 1 where it changes with its clock."""
    ahead = np.diff(np.flatnonzero(np.diff(x)))
    if ahead.size < _FEWEST:
        return 1.0
    shortest = float(np.sort(ahead)[int(_SOONER * (ahead.size - 1))])
    if shortest < 2.0:
        return 1.0
    return float(np.mean(ahead[ahead < _LATER * shortest]))


def _came_at(x: Array, longest: float) -> Index | None:
    """Samples at which the values of a channel (n,) came, ascending; None if it is not held.

    A value that stays for several periods came again in each; ``longest`` period [samples].

    >>> _came_at(np.repeat([0.0, 4.0, 8.0] * 10, 4), 10)[:3]
    array([0, 4, 8])
    """
    period = _period_of(x)
    if not 1.0 < period <= longest:
        return None
    first = np.concatenate([[0], np.flatnonzero(np.diff(x)) + 1])
    length = np.diff(np.append(first, x.size))
    values = np.maximum(1, np.floor(length / period + 1.0 - _SAME).astype(np.int64))
    turn = np.arange(values.sum()) - np.repeat(np.cumsum(values) - values, values)
    came = np.repeat(first, values) + np.round(turn * period).astype(np.int64)
    return np.asarray(came[came < x.size])


def without_holds(log: Log) -> Log:
    """The log with `_CHANNELS` interpolated between their values, cut at the first last value."""
    longest, end = _LONGEST / log.sample_time, log.time.size
    channels, straight = dict(log.channels), set(log.interpolated)
    for name in (c for c in _CHANNELS if c in log):
        came = _came_at(log[name], longest)
        if came is not None:
            channels[name] = np.interp(np.arange(log.time.size), came, log[name][came])
            end = min(end, int(came[-1]) + 1)
            straight.add(name)
    cut = {name: x[:end] for name, x in channels.items()}
    return replace(log, channels=cut, interpolated=tuple(sorted(straight)))

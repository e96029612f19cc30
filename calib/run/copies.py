"""Channels that are no independent measurement: derivatives, copies, held values.

Two sensors have independent noise, two copies share it (`shares_of_speed`, `copied_pairs`).

A channel is held where a logger repeats the last value of a slower bus, which sends GPS at 10 Hz,
a_x and wheels at 50 or 100 Hz. It has steps, and is late by half a step on average. `without_holds`
interpolates it between the samples at which its values arrived.
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

_REACH, _MOST_LAGS = 0.15, 40  # reach of a derivative to both sides [s], and at most [samples]
_ONE_SIGNAL = bounds_of("same_signal")[1]  # correlation of the noise of two copies [1]
_ENOUGH = 4000  # samples that are used
_HELD = 1.5  # mean samples per value from which a channel is held
_CHANNELS = ("p_mc", "a_x", "v", *WHEEL_SPEEDS)  # that are interpolated: inputs of a diagnosis
_FEWEST, _SOONER = 20, 0.1  # changes needed for a period; share that may come sooner, by jitter
_LATER = 1.6  # longest time between two changes that counts as one period [periods]
_AGAIN = 0.6  # time after a period from which a value that stays was sent once more [periods]
_LONGEST = 0.25  # longest period [s]: a channel that changes less often rests, or is coarse


def shares_of_speed(log: Log) -> Iterator[tuple[str, float]]:
    """Yield v and the wheel speeds with the share of the noise of a_x that they explain [1].

    A derivative is a weighted sum of nearby values of the speed, which explain all of its noise,
    but none of an accelerometer's. Nothing is yielded for an a_x without noise, as of a simulation.
    """
    if not _is_noise(log, "a_x"):
        return
    reach = min(max(2, round(_REACH / log.sample_time)), _MOST_LAGS)
    wheels = np.mean([log[name] for name in WHEEL_SPEEDS], axis=0)
    speeds = {"v": log["v"]} if "v" in log else {}
    a_x = np.diff(log["a_x"][:_ENOUGH], 2)  # second differences show the noise
    for name, speed in {**speeds, "the wheel speeds": wheels}.items():
        x = np.diff(speed[:_ENOUGH], 2)
        count = 2 * reach + 1  # weights of the sum
        n = a_x.size - 2 * reach
        if n < 4 * count or not (np.any(x) and np.any(a_x)):
            continue
        nearby = np.lib.stride_tricks.sliding_window_view(x, count).T.copy()  # (count, n)
        y = a_x[reach : reach + n]
        residual = float(residual_squares(inner_products(nearby[None], y))[0])
        per_freedom = n / (n - count) * residual  # the weights fit some of the noise by chance
        yield name, 1.0 - per_freedom / float(y @ y)


def copied_pairs(log: Log, names: Sequence[str]) -> Iterator[tuple[str, str, float]]:
    """Yield pairs of channels that are copies, each with the correlation of its noise [1].

    If both are held, copies change in the same samples, so only these samples are compared. The
    noise must correlate also without the samples that change most: a bump shakes all wheels.
    """
    periods = {name: _mean_period(log[name]) for name in names}
    noise = {name: _unit(_second_differences(log, name)) for name in names}
    for first, second in combinations(names, 2):
        compared, x, y = log, noise[first], noise[second]
        if min(periods[first], periods[second]) >= _HELD:
            steps = np.flatnonzero(np.diff(log[first])) + 1
            at_steps = {name: values[steps] for name, values in log.channels.items()}
            compared = replace(log, channels=at_steps)
            x, y = (_unit(_second_differences(compared, name)) for name in (first, second))
        if abs(float(x @ y)) > _ONE_SIGNAL and _is_noise(compared, first):
            size = x**2 + y**2
            calm = size <= np.quantile(size, LIMITS.copy_calmer)
            norm = float(np.linalg.norm(x[calm]) * np.linalg.norm(y[calm]))
            correlation = abs(float(x[calm] @ y[calm])) / norm if norm > 0.0 else 0.0
            if correlation > _ONE_SIGNAL:
                yield first, second, correlation


def _second_differences(log: Log, channel: str) -> Array:
    """Second differences of a channel, without those over a gap, which all channels share."""
    even = np.diff(log.time) <= GAP * log.sample_time
    return np.asarray(np.diff(log[channel], 2)[even[1:] & even[:-1]])


def _unit(x: Array) -> Array:
    norm = float(np.linalg.norm(x))
    return x / norm if norm > 0.0 else x


def _is_noise(log: Log, channel: str) -> bool:
    """Whether the second differences alternate in sign, as noise does, and exceed the rounding."""
    differences = _second_differences(log, channel)
    square = float(differences @ differences)
    rounding = LIMITS.copy_steps * resolution_of(log[channel])
    exceeds = square > rounding**2 * differences.size
    # the correlation of neighbours is -2/3 for white noise, and up to 1 for motion
    return exceeds and float(differences[1:] @ differences[:-1]) < -0.3 * square


def _mean_period(x: Array) -> float:
    """Samples [1] for which a channel (n,) keeps each value; 1 for a channel that is not held."""
    lengths = np.diff(np.flatnonzero(np.diff(x)))
    if lengths.size < _FEWEST:
        return 1.0
    shortest = float(np.sort(lengths)[int(_SOONER * (lengths.size - 1))])
    if shortest < 2.0:
        return 1.0
    return float(np.mean(lengths[lengths < _LATER * shortest]))


def _arrivals(x: Array, longest: float) -> Index | None:
    """Samples at which the values of a channel (n,) arrived; None if it is not held.

    A value that stays for several periods arrived once in each; none exceeds ``longest`` [samples].

    >>> _arrivals(np.repeat([0.0, 4.0, 8.0] * 10, 4), 10)[:3]
    array([0, 4, 8])
    """
    period = _mean_period(x)
    if not 1.0 < period <= longest:
        return None
    first = np.concatenate([[0], np.flatnonzero(np.diff(x)) + 1])  # sample of each new value
    length = np.diff(np.append(first, x.size))
    # arrivals of each value: one more from each whole number of periods and `_AGAIN` on
    counts = np.maximum(1, np.floor(length / period + 1.0 - _AGAIN).astype(np.int64))
    # number of each arrival among those of its value: 0, 1 ...
    number = np.arange(counts.sum()) - np.repeat(np.cumsum(counts) - counts, counts)
    arrivals = np.repeat(first, counts) + np.round(number * period).astype(np.int64)
    return np.asarray(arrivals[arrivals < x.size])


def without_holds(log: Log) -> Log:
    """Return the log with held channels interpolated, cut where the first of them ends."""
    longest, end = _LONGEST / log.sample_time, log.time.size
    channels, interpolated = dict(log.channels), set(log.interpolated)
    for name in (channel for channel in _CHANNELS if channel in log):
        arrivals = _arrivals(log[name], longest)
        if arrivals is not None:
            channels[name] = np.interp(np.arange(log.time.size), arrivals, log[name][arrivals])
            end = min(end, int(arrivals[-1]) + 1)
            interpolated.add(name)
    cut = {name: x[:end] for name, x in channels.items()}
    return replace(log, channels=cut, interpolated=tuple(sorted(interpolated)))

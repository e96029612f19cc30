"""Channels that keep a value until the next one comes, as a straight line between their values.

A bus sends each message at a rate of its own: 10 Hz for a receiver of satellites, 50 or 100 Hz for
a_x and the wheels. A logger with a faster clock repeats the last value. While the car brakes such a
channel makes steps that no noise of the unbraked parts shows, and it is late by half a step on the
mean. Where the values came, they are as true as those of any other channel.

What this cannot know is how late a value comes: a message that waits, or is computed for long, is a
delay (`calib.car.effects.speed_delay`).
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.base.names import WHEELS
from calib.logs.log import Log

Array = NDArray[np.float64]
Index = NDArray[np.int64]

CHANNELS = ("p_mc", "a_x", "v", *(f"omega_{wheel}" for wheel in WHEELS))
"""Those that a diagnosis compares, or is driven by."""

FEWEST = 20
"""Changes of a channel from which on its period can be told."""

SOONER = 0.1
"""Share of the changes that may come sooner than a period: messages jitter."""

LATER = 1.6
"""Longest time between two values that counts as one period [periods]: the next one is not lost."""

SAME = 0.6
"""Rest [periods] from which on an unchanged value counts as one more value, which was the same."""

LONGEST = 0.25
"""Longest period [s]. What changes less often is at rest, or as coarse as a counter."""


def period_of(x: Array) -> float:
    """Samples [1] for which a channel (n,) keeps each value; 1 where it changes with its clock."""
    ahead = np.diff(np.flatnonzero(np.diff(x)))
    if ahead.size < FEWEST:
        return 1.0
    shortest = float(np.quantile(ahead, SOONER, method="lower"))
    if shortest < 2.0:
        return 1.0
    return float(np.mean(ahead[ahead < LATER * shortest]))


def came_at(x: Array, longest: float) -> Index | None:
    """Samples at which the values of a channel (n,) came, ascending; None for those of its clock.

    A value that stays for several periods came again with each. One that is kept for more than
    ``longest`` [samples] is not one that is sent.

    >>> came_at(np.repeat([0.0, 4.0, 8.0] * 10, 4), 10)[:3]
    array([0, 4, 8])
    """
    period = period_of(x)
    if not 1.0 < period <= longest:
        return None
    first = np.concatenate([[0], np.flatnonzero(np.diff(x)) + 1])
    length = np.diff(np.append(first, x.size))
    values = np.maximum(1, np.floor(length / period + 1.0 - SAME).astype(np.int64))
    turn = np.arange(values.sum()) - np.repeat(np.cumsum(values) - values, values)
    came = np.repeat(first, values) + np.round(turn * period).astype(np.int64)
    return np.asarray(came[came < x.size])


def without_holds(log: Log) -> Log:
    """The log with each of `CHANNELS` in straight lines between its values, up to the last of them.

    It ends where the first of the channels has its last value.
    """
    longest, end = LONGEST / log.sample_time, log.time.size
    channels, straight = dict(log.channels), set(log.interpolated)
    for name in (c for c in CHANNELS if c in log):
        came = came_at(log[name], longest)
        if came is not None:
            channels[name] = np.interp(np.arange(log.time.size), came, log[name][came])
            end = min(end, int(came[-1]) + 1)
            straight.add(name)
    cut = {name: x[:end] for name, x in channels.items()}
    return replace(log, channels=cut, interpolated=tuple(sorted(straight)))

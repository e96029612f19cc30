"""Channels that keep a value until the next one comes, as a straight line between their values.

A bus sends each message at a rate of its own: 10 Hz for a receiver of satellites, 50 or 100 Hz for
a_x and the wheels. A logger with a faster clock repeats the last value. While the car brakes such a
channel makes steps that no noise of the unbraked parts shows, and it is late by half a step on the
mean. Where the values came, they are as true as those of any other channel.

What this cannot know is how late a value comes: a message that waits, or is computed for long, is a
delay (`calib.physics.effects.speed_delay`).
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.logs.log import Log
from calib.names import WHEELS

Array = NDArray[np.float64]

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


def between_values(x: Array, longest: float) -> Array:
    """A channel (n,) in straight lines between the samples at which its values came.

    A value that stays for several periods came again with each. One that changes with its clock, or
    is kept for more than ``longest`` [samples], is not changed.

    >>> between_values(np.repeat([0.0, 4.0, 8.0] * 10, 4), 10)[:9]
    array([0., 1., 2., 3., 4., 5., 6., 7., 8.])
    """
    period = period_of(x)
    if not 1.0 < period <= longest:
        return x
    first = np.concatenate([[0], np.flatnonzero(np.diff(x)) + 1])
    length = np.diff(np.append(first, x.size))
    values = np.maximum(1, np.floor(length / period + 1.0 - SAME).astype(np.int64))
    turn = np.arange(values.sum()) - np.repeat(np.cumsum(values) - values, values)
    came = np.repeat(first, values) + np.round(turn * period).astype(np.int64)
    came = came[came < x.size]
    return np.asarray(np.interp(np.arange(x.size), came, x[came]))


def without_holds(log: Log) -> Log:
    """The log with each of `CHANNELS` in straight lines between its values."""
    longest = LONGEST / log.sample_time
    straight = {c: between_values(log[c], longest) for c in CHANNELS if c in log}
    return replace(log, channels={**log.channels, **straight})

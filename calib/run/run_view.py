"""A run on an even clock, as it is compared with another one: its channels, and their noise."""

import math

import numpy as np
from numpy.typing import NDArray

from calib.base.names import WHEELS
from calib.car.lag import integral
from calib.logs.log import Log
from calib.run.sensors import resolution_of

Array = NDArray[np.float64]


COMPARED = ("p_mc", "a_x", *(f"omega_{w}" for w in WHEELS), "v")

NORMAL = 1.4826
"""Standard deviation over the median of the absolute values, of normal noise [1]."""

View = dict[str, Array]
"""Channels [SI] on an even clock, and the mean of the ``wheels``."""


def view_of(log: Log, step: float, *, means: bool, offset: float = 0.0) -> View:
    """The channels every ``step`` [s] from ``offset`` [s] on: interpolated, or means of a step."""
    time = np.arange(log.time[0] + offset, log.time[-1] + 1e-9, step)
    channels = {}
    for name in COMPARED:
        if name in log:
            x = integral(log.time, log[name]) if means else log[name]
            at = np.interp(time, log.time, x)
            channels[name] = np.diff(at) / step if means else at
    return with_wheels(channels)


def with_wheels(channels: dict[str, Array]) -> View:
    """The channels with the mean of the wheel speeds."""
    return channels | {"wheels": np.mean([channels[f"omega_{w}"] for w in WHEELS], axis=0)}


def spread(x: Array) -> float:
    """Standard deviation from zero of most of the values: where a braking begins, lags count."""
    return float(NORMAL * np.median(np.abs(x)))


def noise_of(x: Array) -> float:
    """Standard deviation of the noise of a channel and of its rounding, by third differences."""
    return max(spread(np.diff(x, 3)) / math.sqrt(20.0), resolution_of(x) / math.sqrt(12.0))

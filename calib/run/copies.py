"""Channels that are copies of others, by their noise: two sensors have noise of their own."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.base.names import WHEELS
from calib.base.noise import explained_square
from calib.logs.clock import GAP
from calib.logs.log import Log
from calib.run.held import period_of
from calib.run.limits import LIMITS
from calib.run.sensors import resolution_of

Array = NDArray[np.float64]


def made_of_wheels(log: Log) -> bool:
    """Whether ``v`` is a wheel speed times a radius, or a mean of several of them."""
    log = as_sent(log, ("v", *(f"omega_{w}" for w in WHEELS)))
    if not is_noise(log, "v"):
        return False
    wheels = np.array([rough(log, f"omega_{w}") for w in WHEELS])
    return float(explained_square(wheels, rough(log, "v"))) > LIMITS.copy_correlation**2


def as_sent(log: Log, channels: Sequence[str]) -> Log:
    """The log at the samples at which the first of ``channels`` changes, where all are held.

    Values that are kept over several samples all rest and step together, which says nothing of
    where they come from.
    """
    if min(period_of(log[name]) for name in channels) < 1.5:
        return log
    came = np.flatnonzero(np.diff(log[channels[0]])) + 1
    return replace(log, channels={name: x[came] for name, x in log.channels.items()})


def alike(log: Log, one: str, other: str) -> float:
    """Correlation of the noise of two channels [1], 0 to 1; without the samples of a bump."""
    x = np.array([rough(log, one), rough(log, other)])
    far = np.sum(x**2, axis=0)
    x = x[:, far <= np.quantile(far, LIMITS.copy_calmer)]
    size = float(np.prod(np.linalg.norm(x, axis=1)))
    return abs(float(x[0] @ x[1])) / size if size > 0.0 else 0.0


def rough(log: Log, channel: str) -> Array:
    """Second differences of a channel, of length 1 as a vector."""
    differences = _differences(log, channel)
    size = float(np.linalg.norm(differences))
    return differences / size if size > 0.0 else differences


def _differences(log: Log, channel: str) -> Array:
    """Second differences of a channel without those over a gap, which every channel has alike."""
    steps = np.diff(log.time)
    even = steps <= GAP * log.sample_time
    return np.asarray(np.diff(log[channel], 2)[even[1:] & even[:-1]])


def is_noise(log: Log, channel: str) -> bool:
    """Whether the second differences are more than rounding, and those of noise.

    Those of noise change their sign from one to the next, those of a smooth signal do not.
    """
    differences = _differences(log, channel)
    square = float(differences @ differences)
    rounding = LIMITS.copy_steps * resolution_of(log[channel])
    above = square > rounding**2 * differences.size
    return above and float(differences[1:] @ differences[:-1]) < -0.3 * square

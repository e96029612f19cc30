"""Add sensor noise to a simulated log; the same seed gives the same noise.

    reading = round(truth + white + x),   coloured: x[k+1] = a x[k] + shock,   a = exp(-dt/0.1 s)

White noise and shocks are normal and independent. The default levels are those of the coasting log
of `sample_logs/sedan`, where much of the accelerometer's variance is slow, by motion of the body.
"""

import zlib
from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from calib.base.arrays import Array
from calib.base.digest import content_digest
from calib.base.names import WHEELS
from calib.logs.log import Log

_TIME_CONSTANT = 0.1  # correlation time of the coloured part [s]


@dataclass(frozen=True)
class NoiseLevel:
    """Noise of one channel, in the SI unit of the channel."""

    sd: float  # standard deviation before rounding
    coloured: float = 0.0  # share of the variance that is correlated in time [1]
    quantum: float = 0.0  # step of the reading, 0 for none
    floor: float = -np.inf  # lowest reading


LEVELS: dict[str, NoiseLevel] = {
    "a_x": NoiseLevel(0.055, 0.45, 0.005),
    "v": NoiseLevel(0.02, 0.0, 0.001),
    "p_mc": NoiseLevel(0.09e5, 0.0, 0.1e5, 0.0),
    **{f"omega_{w}": NoiseLevel(0.02, 0.20, 0.005) for w in WHEELS},
    **{f"p_{w}": NoiseLevel(0.09e5, 0.0, 0.1e5, 0.0) for w in WHEELS},
}


def add_noise(log: Log, seed: int, levels: Mapping[str, NoiseLevel] = LEVELS) -> Log:
    """Return the log with sensor noise; channels without a level, and the truth, are not changed.

    The coloured part takes the clock as uniform, with the median step.
    """
    channels = dict(log.channels)
    for name in channels.keys() & levels.keys():
        # every channel has its own numbers, so that an additional channel changes no other
        random = np.random.default_rng([seed, zlib.crc32(name.encode())])
        channels[name] = reading(channels[name], levels[name], log.sample_time, random)
    content = {"channels": channels, "truth": log.truth}
    digest = content_digest({"name": log.name, "noise": seed}, content)
    notes = (*log.notes, f"sensor noise added with seed {seed}")
    return replace(log, channels=channels, digest=digest, notes=notes)


def reading(
    truth: Array, level: NoiseLevel, sample_time: float, random: np.random.Generator
) -> Array:
    """Reading (n,) of a sensor for its ``truth`` (n,), sampled every ``sample_time`` [s]."""
    from scipy.signal import lfilter

    white = level.sd * np.sqrt(1.0 - level.coloured) * random.standard_normal(truth.size)
    a = np.exp(-sample_time / _TIME_CONSTANT)
    shocks = random.standard_normal(truth.size)
    shocks[1:] *= np.sqrt(1.0 - a * a)  # the first sample has the stationary distribution
    colour = level.sd * np.sqrt(level.coloured) * lfilter([1.0], [1.0, -a], shocks)
    noisy: Array = truth + white + colour
    if level.quantum:
        noisy = np.round(noisy / level.quantum) * level.quantum
    return np.asarray(np.maximum(noisy, level.floor))

"""What is left on the hold-outs with an explanation: how much, where, and when.

A replay uses pressure and first speed only, so a small lasting error, which an innovation of one
step hides, adds up there. Means over half a second show where the error lasts: the noise of the
sensors cancels in them.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.diagnosis.replays.gap import CHANNELS, beyond_noise, error_of, noises_of
from calib.logs.log import Log
from calib.run.filters import block_mean

BLOCK = 0.5
"""Span of a mean [s]: several times the correlation time of a road's noise, a part of a stop."""


@dataclass(frozen=True)
class Remainder:
    """What is left in the replays.

    ``size`` rms of their errors without noise, over the noise of the sensors [1]; ``channel``,
    ``log`` where that is ``largest`` [1]; ``pressure`` [Pa], ``speed`` [m/s], ``time`` [s since the
    start] ranges of 80 % of it there.
    """

    size: float
    channel: str
    log: str
    largest: float
    pressure: tuple[float, float]
    speed: tuple[float, float]
    time: tuple[float, float]


def remainder_of(replays: Sequence[Log], measured: Sequence[Log]) -> Remainder:
    """What replays of ``measured`` logs leave; a replay that ends early as far as it goes."""
    left = beyond_noise(replays, measured, noises_of(measured))
    row, column = divmod(int(np.argmax(left)), len(CHANNELS))
    log, channel = measured[row], CHANNELS[column]
    size = max(1, round(BLOCK / log.sample_time))
    error = block_mean(error_of(replays[row], log, channel), size)
    # the speed keeps an error of force: its growth tells where the force is wrong
    weight = np.abs(np.diff(error, prepend=0.0)) if channel == "v" else error**2
    drivers = (log["p_mc"], log["v"], log.time - log.time[0])
    ranges = [range_of(block_mean(x, size), weight) for x in drivers]
    return Remainder(
        float(np.sqrt(np.mean(left))), channel, log.name, float(np.sqrt(left[row, column])), *ranges
    )


def range_of(driver: Array, weight: Array) -> tuple[float, float]:
    """The range of a driver that holds the middle 80 % of the weight."""
    driver = driver[: weight.size]
    order = np.argsort(driver)
    share = np.cumsum(weight[order]) / max(float(np.sum(weight)), 1e-12)
    low, high = np.searchsorted(share, [0.1, 0.9])
    last = driver.size - 1
    return float(driver[order[min(low, last)]]), float(driver[order[min(high, last)]])

"""The gap on hold-outs: open-loop replays less measurement, over the sensors' noise.

A replay uses the pressure, the first speed and, for a ripple alone, the angle of the wheels, so an
error of force, which an innovation of one step hides, adds up in v. The noise of a channel is
estimated from its differences between samples. Its square is subtracted, so that a perfect model
has no gap. Means over half a second show where an error lasts: the noise cancels in them.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.base.intervals import noise_over
from calib.base.names import WHEELS
from calib.logs.log import Log
from calib.run.filters import block_mean

UNITS = {"a_x": "m/s^2", **{f"omega_{w}": "rad/s" for w in WHEELS}, "v": "m/s"}
CHANNELS = tuple(UNITS)

LONGEST = 0.2
"""Longest time [s] between two samples whose differences show noise: twice the correlation time of
that of a road, and a car hardly moves in that."""

SLOW = 2.0**0.5
"""Largest noise, over what samples that follow each other show of it: half of a road's is slow.
What is more is motion, such as a ripple."""

STRAIGHT = 7.0
"""Differences over four samples, over those from sample to sample, of a channel that runs in
straight lines of four samples or more. A ripple of ten times the noise has four."""

FLOOR = np.where(np.array(CHANNELS) == "v", 0.003, 0.005)
"""Least noise (6,) of the channels, in their units: a simulated log may have none, and no car is
described to better than that."""

BLOCK = 0.5  # span of a mean [s]: several times the correlation time of a road, a part of a stop


@dataclass(frozen=True, eq=False)
class Gap:
    """Mean squares of replay less measurement beyond noise, over those of noise.

    ``squares`` (2, logs, 6) before and after, without and with the effects, by log and channel [1];
    ``logs`` their names; ``noise`` (6,) sd of the channels, in their units.
    """

    logs: tuple[str, ...]
    noise: Array
    squares: Array

    def of(self, log: str | None = None, channel: str | None = None) -> tuple[float, float]:
        """Rms before and after in units of the noise, of one log or all, of one channel or all."""
        rows = [i for i, one in enumerate(self.logs) if log in (None, one)]
        columns = [j for j, one in enumerate(CHANNELS) if channel in (None, one)]
        squares = self.squares[:, rows][:, :, columns]
        before, after = np.sqrt(np.mean(squares, axis=(1, 2))).tolist()
        return before, after

    @property
    def before(self) -> float:
        """Rms of all without the effects, in units of the noise."""
        return self.of()[0]

    @property
    def after(self) -> float:
        """Rms of all with the effects, in units of the noise."""
        return self.of()[1]

    @property
    def closed(self) -> float:
        """Share of the gap that is closed [1], 0 where there is none."""
        before, after = self.of()
        return 1.0 - after / before if before > 0.0 else 0.0


@dataclass(frozen=True)
class Remainder:
    """What is left in the replays with an explanation.

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
    unit: str = "rms of replay errors over the noise of the sensors"


def gap_of(before: Sequence[Log], after: Sequence[Log], measured: Sequence[Log]) -> Gap:
    """Compare replays with their logs, over their common samples above 1 m/s."""
    noise = noises_of(measured)
    squares = [
        [np.mean(errors_of(*pair) ** 2, axis=1) for pair in zip(replays, measured, strict=True)]
        for replays in (before, after)
    ]
    beyond = np.maximum(np.array(squares) / noise**2 - 1.0, 0.0)
    return Gap(tuple(log.name for log in measured), noise, beyond)


def errors_of(replay: Log, measured: Log) -> Array:
    """Replay less measurement (6, n), over their common samples."""
    n = min(replay.time.size, measured.time.size)
    return np.stack([replay[c][:n] - measured[c][:n] for c in CHANNELS])


def noises_of(measured: Sequence[Log]) -> Array:
    """Sd of the noise of every channel (6,), that of the median log, at least `FLOOR`."""
    shown = [[_noise_of(log, channel) for channel in CHANNELS] for log in measured]
    return np.maximum(np.median(shown, axis=0), FLOOR)


def _noise_of(log: Log, channel: str) -> float:
    """The largest that third differences over up to `LONGEST` show, which hold almost no motion.

    A channel that runs in straight lines between its values shows little from sample to sample.
    """
    fine = float(np.std(np.diff(log[channel], 3)) / np.sqrt(20.0))
    over = [fine, *noise_over(log[channel], LONGEST / log.sample_time)]
    straight = channel in log.interpolated or max(over[:4]) > STRAIGHT * fine
    return max(over) if straight else min(max(over), SLOW * fine)


def remainder_of(gap: Gap, replays: Sequence[Log], measured: Sequence[Log]) -> Remainder:
    """What ``replays`` leave of ``measured`` logs, after a ``gap``."""
    left = gap.squares[1]
    row, column = divmod(int(np.argmax(left)), len(CHANNELS))
    log, channel = measured[row], CHANNELS[column]
    size = max(1, round(BLOCK / log.sample_time))
    error = block_mean(errors_of(replays[row], log)[column], size)
    # the speed keeps an error of force: its growth tells where the force is wrong
    weight = np.abs(np.diff(error, prepend=0.0)) if channel == "v" else error**2
    drivers = (log["p_mc"], log["v"], log.time - log.time[0])
    pressure, speed, time = (range_of(block_mean(x, size), weight) for x in drivers)
    largest = float(np.sqrt(left[row, column]))
    return Remainder(gap.after, channel, log.name, largest, pressure, speed, time)


def range_of(driver: Array, weight: Array) -> tuple[float, float]:
    """The range of a driver that holds the middle 80 % of the weight."""
    driver, some = driver[: weight.size], weight + 1e-12  # where nothing is left, all counts alike
    low, high = np.quantile(driver, (0.1, 0.9), weights=some, method="inverted_cdf")
    return float(low), float(high)

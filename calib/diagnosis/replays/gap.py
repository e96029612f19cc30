"""The gap on hold-outs: open-loop replays less measurement, over the sensors' noise.

A replay uses the pressure, the first speed and, for a ripple alone, the angle of the wheels, so an
error of force adds up in v. The noise of
a channel is estimated from its differences between samples. Its square is subtracted, so that a
perfect model has no gap.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.base.intervals import QUARTILE
from calib.base.names import WHEELS
from calib.logs.log import Log
from calib.run.filters import third_difference, typical_differences

Array = NDArray[np.float64]

CHANNELS = ("a_x", *(f"omega_{w}" for w in WHEELS), "v")
UNITS = {"a_x": "m/s^2", "v": "m/s", **{f"omega_{w}": "rad/s" for w in WHEELS}}

LONGEST = 0.1
"""Longest time [s] between two samples whose differences show noise: a car hardly moves in that."""

STRAIGHT = 7.0
"""Differences over four samples, over those from sample to sample, of a channel that runs in
straight lines of four samples or more. A ripple of ten times the noise has four."""

ROAD, MOST_SLOW = 0.1, 1.0
"""Correlation time [s] of the slow part of the noise, that of a body on a road, and its largest
variance over that of the differences from sample to sample."""

_OUTLYING = 3.0
"""Size of a difference, in standard deviations, from which it counts as this: it has motion in it.
"""

FLOOR = {"a_x": 0.005, "v": 0.003, **{f"omega_{w}": 0.005 for w in WHEELS}}
"""Least noise of a channel, in its unit: a simulated log may have none, and no car is described to
better than that."""


@dataclass(frozen=True)
class ChannelGap:
    """Rms of replay less measurement before and after, without noise; unit of the channel."""

    before: float
    after: float
    noise: float

    @property
    def closed(self) -> float | None:
        """Share of the gap that is closed [1]; None where there was none."""
        return 1.0 - self.after / self.before if self.before > 0.0 else None

    @property
    def within_noise(self) -> bool:
        """Whether the channel has less gap than noise, before and after."""
        return max(self.before, self.after) < self.noise


@dataclass(frozen=True)
class Gap:
    """Gap over all hold-outs, channels in units of their noise.

    ``before`` without, ``after`` with the effects; ``closed`` the share of it that is closed [1];
    ``by_channel``, ``by_log`` (before, after); ``cells`` by log, then by channel.
    """

    before: float
    after: float
    closed: float
    by_channel: dict[str, ChannelGap]
    by_log: dict[str, tuple[float, float]]
    cells: dict[str, dict[str, ChannelGap]]


def gap_of(before: Sequence[Log], after: Sequence[Log], measured: Sequence[Log]) -> Gap:
    """Compare replays with their logs; a replay that ends early is compared up to its end."""
    floor = noises_of(measured)
    noise = dict(zip(CHANNELS, floor.tolist(), strict=True))
    squares = {"before": _squares_of(before, measured), "after": _squares_of(after, measured)}
    excess = {key: np.maximum(value - floor**2, 0.0) for key, value in squares.items()}
    scaled = {key: value / floor**2 for key, value in excess.items()}
    total = {key: float(np.sqrt(np.mean(value))) for key, value in scaled.items()}
    by_log = {
        log.name: (
            float(np.sqrt(np.mean(scaled["before"][i]))),
            float(np.sqrt(np.mean(scaled["after"][i]))),
        )
        for i, log in enumerate(measured)
    }
    by_channel = {
        c: ChannelGap(
            before=float(np.sqrt(np.mean(excess["before"][:, j]))),
            after=float(np.sqrt(np.mean(excess["after"][:, j]))),
            noise=noise[c],
        )
        for j, c in enumerate(CHANNELS)
    }
    rms = {key: np.sqrt(value) for key, value in excess.items()}
    cells = {
        log.name: {
            c: ChannelGap(float(rms["before"][i, j]), float(rms["after"][i, j]), noise[c])
            for j, c in enumerate(CHANNELS)
        }
        for i, log in enumerate(measured)
    }
    closed = 1.0 - total["after"] / total["before"] if total["before"] > 0.0 else 0.0
    return Gap(total["before"], total["after"], closed, by_channel, by_log, cells)


def _squares_of(simulated: Sequence[Log], measured: Sequence[Log]) -> Array:
    """Mean squares by log and channel."""
    pairs = zip(simulated, measured, strict=True)
    return np.array([[square(sim, log, c) for c in CHANNELS] for sim, log in pairs])


def noises_of(measured: Sequence[Log]) -> Array:
    """Sd of the noise of every channel (6,), at least `FLOOR`; of fast and slow the median log's.

    From third differences, which hold almost no motion. Those from sample to sample do not show
    what is slow in the noise. That of a road has a correlation time of `ROAD`: differences over
    half of it show a part that is known. It is at most `MOST_SLOW` of the fast part: what is more
    is motion, such as a ripple.
    """
    return np.array([max(_noise_of(measured, channel), FLOOR[channel]) for channel in CHANNELS])


def _noise_of(measured: Sequence[Log], channel: str) -> float:
    fast, slow = np.median([_differences(log, channel) for log in measured], axis=0)
    return float(np.sqrt((fast + min(max(slow, 0.0), MOST_SLOW * fast)) / 20.0))


def _differences(log: Log, channel: str) -> tuple[float, float]:
    """Variance of third differences from sample to sample, and what is slow that they do not show.

    A channel that runs in straight lines between its values shows little from sample to sample:
    what counts then are differences over more samples, up to `LONGEST`.
    """
    x, step = log[channel], log.sample_time
    fine = float(np.std(third_difference(x, 1)))
    over = typical_differences(x, LONGEST / step)
    if channel in log.interpolated or max(over[:3], default=0.0) > STRAIGHT * fine:
        return max(fine, *over) ** 2, 0.0
    lag = round(0.5 * ROAD / step)
    if lag < 2 or 3 * lag >= x.size:
        return fine**2, 0.0
    across = third_difference(x, lag)
    most = _OUTLYING * float(np.median(np.abs(across))) / QUARTILE
    slow = (np.var(np.clip(across, -most, most)) - fine**2) / (_shown(lag * step) - _shown(step))
    return fine**2, (1.0 - _shown(step)) * float(slow)


def _shown(time: float) -> float:
    """Variance of third differences over ``time`` [s] of the road's noise, over that of white."""
    rho = np.exp(-time / ROAD)
    return float(1.0 - 1.5 * rho + 0.6 * rho**2 - 0.1 * rho**3)


def square(simulated: Log, measured: Log, channel: str) -> float:
    """Mean square of replay less measurement over their common samples above 1 m/s."""
    n = min(simulated.time.size, measured.time.size)
    return float(np.mean((simulated[channel][:n] - measured[channel][:n]) ** 2))

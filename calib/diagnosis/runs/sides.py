"""Left and right wheels of an axle roll alike where nothing brakes: their radii are of the day.

    omega_l/omega_r, unbraked, over all logs --> half of it to each side

Tyres of one axle differ by 0.1 % in radius as they wear, and by 0.5 % if one is new, which is ten
times and more what a sensor of speed shows over a log. It would hide every other effect. Radii of
the axles are not touched: their mismatch is an effect. A brake that drags on one wheel looks alike,
but it also slows the car: an explanation of logs with even sides in which something slows the car,
or is left, may be that brake, unless the difference is as small as tyres of one age make it.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calib.base.names import AXLES
from calib.car.braking import BITE
from calib.logs.log import Log

USUAL, LARGEST = 1e-3, 5e-3
"""Difference of the sides [1] that tyres of one age make, and the largest that tyres make; a seized
brake makes 0.1 to 0.8 %."""

_SETTLED = 0.3
"""Time before the first braking that is left out [s]: means over a lead-in end before the bite."""

_SLOW = 10.0
"""Wheel speed [rad/s], about 3 m/s, below which the sensors are too inexact."""

_LEAST = 0.5
"""Seconds of rolling, of all logs together, from which the sides are compared."""


def with_even_sides(
    logs: Sequence[Log], largest: float = USUAL
) -> tuple[list[Log], dict[str, float]]:
    """The logs with left and right wheel speeds of each axle equal on the mean while unbraked.

    One ratio for each axle from all logs together, so they must be of one car with one set of
    tyres. An axle stays as it is where the logs roll for less than `_LEAST` without braking,
    or its sides differ by more than ``largest`` [1]. Also returns right over left less one [1] by
    axle, zero where it stays.
    """
    ratios = {axle: _ratio(logs, axle, largest) for axle in AXLES}
    evened = [_evened(log, ratios) for log in logs]
    return evened, {axle: ratio - 1.0 for axle, ratio in ratios.items()}


def _ratio(logs: Sequence[Log], axle: str, largest: float) -> float:
    """Right over left wheel speed [1] where no log is braked yet; 1 if it cannot be the tyres."""
    left = right = seconds = 0.0
    for log in logs:
        n, step = _rolling(log), log.sample_time
        left += float(np.sum(log[f"omega_{axle}l"][:n])) * step
        right += float(np.sum(log[f"omega_{axle}r"][:n])) * step
        seconds += n * step
    if seconds < _LEAST or left <= 0.0 or abs(right / left - 1.0) > largest:
        return 1.0
    return right / left


def _rolling(log: Log) -> int:
    """Samples before the first braking, and before the car is slow."""
    ends = np.flatnonzero((log["p_mc"] > 0.5 * BITE) | (log["omega_fl"] < _SLOW))
    if not ends.size:
        return int(log.time.size)
    return max(int(ends[0]) - round(_SETTLED / log.sample_time), 0)


def _evened(log: Log, ratios: dict[str, float]) -> Log:
    channels = dict(log.channels)
    for axle, ratio in ratios.items():
        channels[f"omega_{axle}l"] = channels[f"omega_{axle}l"] * np.sqrt(ratio)
        channels[f"omega_{axle}r"] = channels[f"omega_{axle}r"] / np.sqrt(ratio)
    return replace(log, channels=channels)

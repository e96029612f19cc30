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
from calib.logs.log import Log
from calib.run.driving_record import driving_record

USUAL, LARGEST = 1e-3, 5e-3
"""Difference of the sides [1] that tyres of one age make, and the largest that tyres make; a seized
brake makes 0.1 to 0.8 %."""


def with_even_sides(logs: Sequence[Log], largest: float) -> tuple[list[Log], dict[str, float]]:
    """The logs with left and right wheel speeds of each axle equal on the mean while unbraked.

    One ratio for each axle from all logs together, so they must be of one car with one set of
    tyres. An axle stays as it is where its sides differ by more than ``largest`` [1]. Also returns
    right over left less one [1] by axle, zero where it stays.
    """
    rolling = [driving_record(log).unbraked for log in logs]
    even, sides = list(logs), dict.fromkeys(AXLES, 0.0)
    for axle in AXLES:
        left, right = (
            sum(
                log.sample_time * float(np.sum(log[f"omega_{axle}{side}"][free]))
                for log, free in zip(logs, rolling, strict=True)
            )
            for side in "lr"
        )
        if 0.0 < abs(right - left) <= largest * left:
            sides[axle] = right / left - 1.0
            even = [_evened(log, axle, np.sqrt(right / left)) for log in even]
    return even, sides


def _evened(log: Log, axle: str, factor: float) -> Log:
    left, right = f"omega_{axle}l", f"omega_{axle}r"
    even = {left: log[left] * factor, right: log[right] / factor}
    return replace(log, channels=log.channels | even)

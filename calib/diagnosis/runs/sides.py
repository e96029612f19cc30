"""Left and right wheels of an axle roll alike where nothing brakes: their radii are of the day.

    omega_l/omega_r, unbraked, over all logs --> half of it to each side

They differ by ten times and more what a sensor of speed shows over a log, which would hide every
other effect. Radii of the axles are not touched: their mismatch is an effect. A brake that drags on
one wheel looks alike, but it also slows the car.
"""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np

from calib.base.names import AXLES
from calib.logs.log import Log
from calib.run.driving_record import driving_record

# differences of the sides [1]; a seized brake makes 0.001 to 0.008
USUAL = 1e-3  # that tyres of one age make as they wear
LARGEST = 5e-3  # that one new tyre makes


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

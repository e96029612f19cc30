"""Where the brakes follow the pressure closely enough for pad friction to be their ratio.

    |delay| |p'|/p of the last half second        against half the width of the interval

Pad friction is torque over pressure, and brakes, filters and clocks make the one late against the
other. While a pressure is held that is nothing. While a foot pumps at 1.5 Hz, brakes that follow
after 30 ms make the friction swing by a fifth, and the level, which remembers half a second, swings
behind it. Uses the whole run for the delay.
"""

from dataclasses import replace

import numpy as np
from numpy.typing import NDArray

from calib.estimation.estimator import Estimate
from calib.signals.filters import centred_mean, since
from calib.validation.settings import SETTINGS

Array = NDArray[np.float64]

WHY = "the pressure moves faster than the brakes follow"


def followed(e: Estimate) -> Estimate:
    """The estimate without the samples in which the pressure moves too fast; see `WHY`.

    As it is where the run brakes too little to tell how late the brakes are.
    """
    if e.response is None:
        return e
    p = np.maximum(e.pressure_f, e.pressure_r)
    count = max(round(SETTINGS.followed_smoothed / e.read.sample_time), 1)
    moves = centred_mean(np.gradient(p, e.read.sample_time), count, held_ends=True)
    error = abs(e.response.delay) * np.abs(moves) / np.maximum(p, e.plan.gates.pressure)
    least = np.minimum(e.front.half_width, e.rear.half_width)
    settled = e.braked & (since(e.time, ~e.braked) > e.plan.gates.settle)
    fast = settled & (error > SETTINGS.followed_largest * least)
    late = e.braked & (since(e.time, fast) < SETTINGS.followed_remembered)
    return replace(e, valid=e.valid & ~late, refused={**e.refused, WHY: late})

"""Lateral acceleration by the speeds of left and right wheel, where nobody logs it.

    v^2/R = (omega_r - omega_l)/omega v^2/l_w     rear wheels, of equal radius

Radii that differ by 0.5 % look like 3 m/s^2 at 30 m/s; a run that is known to be straight tells
them.
"""

import numpy as np
from numpy.typing import NDArray

from calib.logs.log import Log
from calib.signals.axle_signals import Signals
from calib.signals.filters import low_pass

Array = NDArray[np.float64]

LATERAL_TIME = 0.2
"""Time constant [s] over which the wheels are compared: their noise alone is 1 m/s^2."""


def sides(log: Log) -> Array:
    """How much faster the right rear wheel turns than the left one [1] (n,)."""
    left, right = log["omega_rl"], log["omega_rr"]
    return np.asarray((right - left) / np.maximum(0.5 * (right + left), 1.0))


def lateral(log: Log, s: Signals, track_width: float, straight: float = 0.0) -> Array:
    """Lateral acceleration [m/s^2] (n,), positive to the left.

    ``track_width`` [m]; ``straight`` what `sides` reads on a straight road [1].
    """
    turned = (sides(log) - straight) * s.speed**2 / track_width
    return low_pass(turned, s.sample_time, LATERAL_TIME)

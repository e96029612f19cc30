"""Lateral acceleration from the speeds of the left and right rear wheels.

    v^2/R = (omega_r - omega_l)/omega v^2/l_w     free-rolling wheels of equal radius

Radii that differ by 0.5 % look like 3 m/s^2 at 30 m/s; a straight run shows that difference.
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.names import G
from calib.car.braking import MOVING
from calib.logs.log import Log
from calib.run.axle_signals import Signals
from calib.run.filters import low_pass

LATERAL_TIME = 0.2  # over which the wheels are compared [s]: their noise alone is 1 m/s^2


def sides(log: Log) -> Array:
    """How much faster the right rear wheel turns than the left one [1] (n,)."""
    left, right = log["omega_rl"], log["omega_rr"]
    return np.asarray((right - left) / np.maximum(0.5 * (right + left), 1.0))


def lateral(
    log: Log,
    s: Signals,
    track_width: float,
    straight: float = 0.0,
    slip: Array | float = 0.0,
    height: float = 0.0,
) -> Array:
    """Lateral acceleration [m/s^2] (n,), positive to the left.

    ``track_width`` [m]; ``straight`` value of `sides` on a straight road [1]; braking ``slip`` of
    the rear wheels [1] (n,); ``height`` of the centre of gravity [m]. Each axle carries its share
    of the roll moment.
    """
    turned = turning(sides(log) - straight, s.speed, track_width, slip, height)
    return low_pass(turned, s.sample_time, LATERAL_TIME)


def turning(
    apart: Array | float,
    speed: Array | float,
    track_width: float,
    slip: Array | float,
    height: float,
) -> Array:
    """`lateral` before the low-pass; ``apart`` value of `sides` [1] and ``speed`` [m/s], (n,)."""
    geometric = track_width / np.maximum(speed, MOVING) ** 2
    # the outer wheel carries 2 h/(g l_w) a_y more of its load and slips less, the inner one more
    leaned = 4.0 * np.maximum(slip, 0.0) * height / (G * track_width)
    return np.asarray(apart / (geometric + leaned))

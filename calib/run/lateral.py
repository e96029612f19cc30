"""Lateral acceleration a_y from the speeds of the left and right rear wheels.

    a_y = ((omega_right - omega_left)/omega) (v^2/l_w)     free-rolling wheels of equal radius

l_w is the track width, omega the mean of both wheels. Wheel radii that
differ by 0.5 % look like 3 m/s^2 at 30 m/s; a straight run shows that difference. `turning` has
the equation for braked wheels.
"""

import numpy as np

from calib.base.arrays import Array
from calib.base.names import G
from calib.car.braking import MOVING
from calib.logs.log import Log
from calib.run.axle_signals import Signals
from calib.run.filters import low_pass

LATERAL_TIME = 0.2  # time constant of the low-pass [s]; unfiltered noise would be 1 m/s^2


def sides(log: Log) -> Array:
    """Right less left rear wheel speed over their mean [1] (n,)."""
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
    """a_y [m/s^2] by `turning`, after a low-pass; ``straight`` is `sides` on a straight road."""
    a_y = turning(sides(log) - straight, s.speed, track_width, slip, height)
    return low_pass(a_y, s.sample_time, LATERAL_TIME)


def turning(
    apart: Array | float,
    speed: Array | float,
    track_width: float,
    slip: Array | float,
    height: float,
) -> Array:
    """Lateral acceleration a_y [m/s^2] (n,), positive in a left bend.

        apart = a_y (l_w/v^2 + 4 slip h/(g l_w))

    ``apart`` is the value of `sides` [1] less that on a straight road, ``speed`` is v [m/s],
    ``track_width`` l_w [m], ``slip`` that of the braked rear wheels [1], ``height`` that of the
    centre of gravity, h [m]. Each axle is taken to carry the roll moment in proportion to its load:
    that of the outer wheel rises by the fraction 2 h a_y/(g l_w), and its slip falls by the same
    fraction; for the inner wheel it is the reverse.
    """
    by_bend = track_width / np.maximum(speed, MOVING) ** 2
    by_load = 4.0 * np.maximum(slip, 0.0) * height / (G * track_width)
    return np.asarray(apart / (by_bend + by_load))

"""Lateral acceleration by the speeds of left and right wheel, where nobody logs it.

    v^2/R = (omega_r - omega_l)/omega v^2/l_w     rear wheels, of equal radius, that roll freely

Radii that differ by 0.5 % look like 3 m/s^2 at 30 m/s; a run that is known to be straight tells
them.
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

    ``track_width`` [m]; ``straight`` what `sides` reads on a straight road [1]; ``slip`` of the
    rear wheels [1] (n,) while they brake, ``height`` of the centre of gravity [m]: each axle is
    taken to carry its share of the roll moment.
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
    """Lateral acceleration [m/s^2] (n,) before the low pass.

    ``apart`` what `sides` reads [1], ``speed`` [m/s], (n,) each; the rest as of `lateral`.
    """
    geometric = track_width / np.maximum(speed, MOVING) ** 2
    # the outer wheel carries 2 h/(g l_w) a_y more of its load and slips less, the inner one more
    leaned = 4.0 * np.maximum(slip, 0.0) * height / (G * track_width)
    return np.asarray(apart / (geometric + leaned))

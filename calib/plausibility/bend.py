"""What left and right wheels of a ramp say against its being straight."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from calib.base.warning import Measured
from calib.car.braking import MOVING
from calib.logs.log import Log
from calib.run.axle_signals import Signals
from calib.run.lateral import lateral, sides

BRAKING = 0.1
"""Deceleration [1] past which left and right are not compared: the inner wheels of a bend bear less
and slip more, which looks like a tighter one."""
WHEEL_SPEED = 10.0
"""Wheel speed [rad/s] from which they are compared: 3 m/s."""


def bend_of(
    ramp: Log, s: Signals, track_width: float, straight: Sequence[Log]
) -> Iterator[Measured]:
    """Mean lateral acceleration of a ramp [m/s^2] by runs of the same car that are ``straight``.

    ``s`` signals of the ramp; ``track_width`` [m]. Without such runs a bend and wheels of unlike
    radius look the same.
    """
    told = (s.speed > MOVING) & (s.z < BRAKING)
    if straight and told.any():
        equal = np.concatenate([sides(log)[_rolls(log)] for log in straight])
        turned = lateral(ramp, s, track_width, float(np.mean(equal)))
        yield Measured("bend", float(np.mean(turned[told])))


def _rolls(log: Log) -> NDArray[np.bool_]:
    """Where the rear wheels turn fast enough to be compared, (n,)."""
    return np.asarray(log["omega_rl"] + log["omega_rr"] > 2.0 * WHEEL_SPEED)

"""What left and right wheels of a ramp say against its being straight."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from calib.logs.log import Log
from calib.messages.warning import PlausibilityWarning
from calib.physics.braking import MOVING
from calib.signals.axle_signals import Signals
from calib.signals.lateral import lateral, sides

LATERAL = 1.5
"""Mean lateral acceleration of a ramp [m/s^2] from which it is named: half of that from which a
sample of a stop is not valid."""

HARD = 0.1
"""Deceleration [1] past which left and right are not compared: the inner wheels of a bend bear less
and slip more, which looks like a tighter one."""

ROLLING = 10.0
"""Wheel speed [rad/s] from which left and right are compared: 3 m/s."""


def bend_warnings(
    ramp: Log, s: Signals, track_width: float, straight: Sequence[Log]
) -> Iterator[PlausibilityWarning]:
    """A ramp that is driven in a bend, by runs of the same car that are ``straight``.

    ``s`` signals of the ramp; ``track_width`` [m]. Without such runs a bend and wheels of unlike
    radius look the same.
    """
    told = (s.speed > MOVING) & (s.z < HARD)
    if not straight or not told.any():
        return
    equal = np.concatenate([sides(log)[_rolls(log)] for log in straight])
    turned = float(np.mean(lateral(ramp, s, track_width, float(np.mean(equal)))[told]))
    if abs(turned) > LATERAL:
        yield PlausibilityWarning(
            "bend",
            ramp.name,
            turned,
            (-LATERAL, LATERAL),
            (
                "a bend in the ramp or the coast log",
                "wheels that were changed between the runs",
            ),
            "drive ramp and coast log straight, and log the steering angle",
        )


def _rolls(log: Log) -> NDArray[np.bool_]:
    """Where the rear wheels turn fast enough to be compared, (n,)."""
    return np.asarray(log["omega_rl"] + log["omega_rr"] > 2.0 * ROLLING)

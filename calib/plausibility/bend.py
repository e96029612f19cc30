"""What left and right wheels of a ramp say against its being straight."""

from collections.abc import Iterator, Sequence

import numpy as np
from numpy.typing import NDArray

from calib.base.warning import PlausibilityWarning, warning
from calib.car.braking import MOVING
from calib.logs.log import Log
from calib.plausibility.limits import PLAUSIBLE
from calib.run.axle_signals import Signals
from calib.run.lateral import lateral, sides


def bend_warnings(
    ramp: Log, s: Signals, track_width: float, straight: Sequence[Log]
) -> Iterator[PlausibilityWarning]:
    """A ramp that is driven in a bend, by runs of the same car that are ``straight``.

    ``s`` signals of the ramp; ``track_width`` [m]. Without such runs a bend and wheels of unlike
    radius look the same.
    """
    told = (s.speed > MOVING) & (s.z < PLAUSIBLE.bend_braking)
    if not straight or not told.any():
        return
    equal = np.concatenate([sides(log)[_rolls(log)] for log in straight])
    turned = float(np.mean(lateral(ramp, s, track_width, float(np.mean(equal)))[told]))
    if abs(turned) > PLAUSIBLE.lateral:
        yield warning("bend", ramp.name, turned, (-PLAUSIBLE.lateral, PLAUSIBLE.lateral))


def _rolls(log: Log) -> NDArray[np.bool_]:
    """Where the rear wheels turn fast enough to be compared, (n,)."""
    return np.asarray(log["omega_rl"] + log["omega_rr"] > 2.0 * PLAUSIBLE.bend_wheel_speed)

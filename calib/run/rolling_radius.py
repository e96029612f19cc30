"""The rolling radius of the wheels of a log whose vehicle is not known."""

import numpy as np

from calib.base.names import WHEELS
from calib.logs.log import Log
from calib.run.driving_record import DrivingRecord

SHORTEST = 0.2
"""Time of rolling [s] from which the radius is given: the noise of v is then 0.1 % or less."""


def rolling_radius(log: Log, driving: DrivingRecord) -> float | None:
    """Mean rolling radius of the four wheels [m] where the car rolls without brakes.

    R = mean(v)/mean(omega), (19) at zero slip. On the lead-in where it is long enough, else in all
    steady unbraked motion; None without ``v`` and without such motion. What drives or slows the
    wheels there, as an engine in gear does, is a part of it: 0.1 % at 0.03 g.
    """
    rolls = driving.unbraked
    if "v" not in log or float(rolls.sum()) * driving.step < SHORTEST:
        return None
    turning = float(np.mean([np.mean(log[f"omega_{w}"][rolls]) for w in WHEELS]))
    return float(np.mean(log["v"][rolls])) / turning if turning > 0.0 else None

"""Which load would make pads that are those of the ramp seem to have changed.

The estimate of a stop knows the mass and the loads of the vehicle file. Under another load the
sum of forces and eta are still true, and what changes is what they are thought to say of the pads:

    sum of forces     c_f s + c_r (1 - s) = W/W'
    eta               s/u - (1 - s)/(1 - u) = d

    c_f, c_r          pads that the estimate finds, over those of the ramp [1]
    s                 front share of the brake force of the ramp's pads [1]
    W, u_0            weight of the file, and the front axle's share of it at this z
    W', u             the same of the car as it is
    d                 (c_f s/u_0 - c_r (1 - s)/(1 - u_0)) W'/W: the difference of the axles' forces
                      over their loads, which eta shows, over z

A tyre whose slip is in proportion to its force is taken. Solved for W' and u they tell how heavy
the load is and over which axle it lies.
"""

import math
from typing import NamedTuple

from calib.plausibility.limits import PLAUSIBLE


class Load(NamedTuple):
    """A load: ``share`` its weight over that of the file's car [1], ``front`` what of it the front
    axle carries at rest [1].
    """

    share: float
    front: float


def load_behind(
    level: float, apart: float, brake_share: float, load_share: float, transfer: float
) -> Load | None:
    """Return the load that makes the pads seem changed.

    ``level`` ln of the brake force over that of the ramp's pads, ``apart`` ln of c_f/c_r;
    ``brake_share`` front share of the brake force of the ramp's pads [1]; ``load_share`` that of
    the weight at the stop's deceleration [1], of which braking has moved ``transfer``. None where
    the car is as heavy as before, or no load does it.

    >>> load = load_behind(-0.1, 0.0, 0.7, 0.7, 0.1)
    >>> round(load.share, 3), round(load.front, 3)  # exp(0.1) - 1, where the weight is
    (0.105, 0.6)
    """
    s, u_0 = brake_share, load_share
    if level == 0.0:
        return None
    c_r = math.exp(level) / (s * math.exp(apart) + 1.0 - s)
    c_f = c_r * math.exp(apart)
    heavier = math.exp(-level)
    d = (c_f * s / u_0 - c_r * (1.0 - s) / (1.0 - u_0)) * heavier
    root = (1.0 + d) ** 2 - 4.0 * d * s
    if root < 0.0:
        return None
    u = 2.0 * s / (1.0 + d + math.sqrt(root))
    share = heavier - 1.0
    return Load(share, (u * heavier - u_0) / share - transfer)


def is_load(*ends: Load | None) -> bool:
    """Whether one load of those between ``ends`` lies where people and bags do.

    They are those of the ends of an interval; None stands for one that no load makes.
    """
    front = [one.front for one in ends if one is not None]
    return bool(front) and min(front) < PLAUSIBLE.seats[1] and max(front) > PLAUSIBLE.seats[0]

"""A run in which one axle alone brakes: seen from the pressures of its axles, not from its name.

The share of such an axle is known, so its eta and slip give its tyres' stiffness without the pads.
"""

from typing import Literal

import numpy as np
from numpy.typing import NDArray

from calib.car.braking import BITE
from calib.logs.log import Log
from calib.run.axle_signals import axle_pressure
from calib.run.blocks import BLOCK
from calib.run.filters import block_mean

Array = NDArray[np.float64]
Axle = Literal["f", "r"]


def braked_alone(p_f: Array, p_r: Array) -> Axle | None:
    """The only axle whose pressure [Pa] passes the bite in any block, (k,); None for both or none.

    Wrong where a brake drags or a motor brakes the other axle: pressures do not show that.
    """
    front, rear = (bool(np.any(p > BITE)) for p in (p_f, p_r))
    if front == rear:
        return None
    return "f" if front else "r"


def braked_alone_in(log: Log) -> Axle | None:
    """`braked_alone` of a log; None where it has no ``p_mc``."""
    if "p_mc" not in log:
        return None
    n = max(1, round(BLOCK / log.sample_time))
    p_f, p_r = (block_mean(axle_pressure(log, axle), n) for axle in ("f", "r"))
    return braked_alone(p_f, p_r)

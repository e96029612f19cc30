"""How the ratio of the pads changes along a ramp, from what the model of constant pads leaves out.

The friction of a pad changes with speed, heat and pressure, and a brake answers a little late and
from a pressure of its own. Each moves both axles, though not alike, and only the difference shows
in eta. In a ramp all of them go with two things: how far the car has slowed, and how small the
pressure still is. A ratio that bends by a few per cent looks like pads that are far from the
declared ones, so a fit must not take it for constant.
"""

import numpy as np
from numpy.typing import NDArray

from calib.run.blocks import Blocks

Array = NDArray[np.float64]

SPEED = 15.0
"""Loss of speed [m/s] for which the drift of a ratio is given: that of a ramp to 0.5 g."""

LEAST_PRESSURE = 2e5
"""Pressure [Pa] from which on a difference of the pressures is small against them."""


def ratio_along(b: Blocks, braked: NDArray[np.bool_], drift: float, pressure_apart: float) -> Array:
    """What comes to the logarithm of the pads' ratio front over rear, per block (k,) [1].

    ``drift`` its change [1] per `SPEED` that the car is slower, about the mean of the ``braked``
    blocks, weighed with their deceleration; ``pressure_apart`` the pressure [Pa] by which less of
    p_mc acts in front than at the rear. Below `LEAST_PRESSURE` the latter is too small.
    """
    z = np.abs(b.z[braked])
    middle = float(z @ b.speed[braked] / z.sum())
    pressure = np.maximum(0.5 * (b.p_f + b.p_r), LEAST_PRESSURE)
    return np.asarray(drift * (middle - b.speed) / SPEED - pressure_apart / pressure)

"""Temperature of a brake disc as one state: heated by the whole braking power, cooled by the air.

C dT/dt = P - (C/tau) (T - T_air)
"""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.physics.lag import first_order

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Disc:
    """One brake disc: ``heat_capacity`` C [J/K] and ``cooling_time`` tau [s]."""

    heat_capacity: float
    cooling_time: float


def disc_temperature(time: Array, power: Array, disc: Disc, start: float, air: float) -> Array:
    """Temperature of one disc [degC], (n,), with ``start`` [degC] at the first sample.

    ``time`` [s] and ``power`` P dissipated in this brake [W], (n,); ``air`` T_air [degC]. Exact for
    a power that is linear between samples. Source: Limpert, Brake Design and Safety, ch. 3, for the
    lumped disc.
    The pads take no heat, all of the disc has one temperature and the air cools at any speed alike:
    not valid for the surface of the disc within a hard stop, nor over minutes of changing speed.
    """
    still = air + power * disc.cooling_time / disc.heat_capacity  # where T would come to rest
    own = np.exp(-(time - time[0]) / disc.cooling_time)
    return np.asarray(first_order(time, still, disc.cooling_time) + (start - still[0]) * own)

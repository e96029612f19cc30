"""Temperature of a brake disc as one state: heated by the whole braking power, cooled by the air.

C dT/dt = P - (C/tau) (T - T_air)
"""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.car.lag import first_order


@dataclass(frozen=True)
class Disc:
    """One brake disc: ``heat_capacity`` C [J/K] and ``cooling_time`` tau [s]."""

    heat_capacity: float
    cooling_time: float


DISCS = {"f": Disc(3700.0, 300.0), "r": Disc(2300.0, 300.0)}
"""Discs of a medium sedan, assumed: 8 kg vented in front, 5 kg solid behind, of grey cast iron of
460 J/(kg K). The cooling time is assumed, too: 0.13 m^2 under 60 to 100 W/(m^2 K) make 280 to 470 s
in front. In a stop of 10 s it takes 2 % of the rise."""

START = 100.0
"""Temperature at the first sample [degC] if it is not logged: the upper end of what UN R13-H, annex
3 calls cold brakes (65 to 100 degC)."""

ALIKE = (START, START)
"""The same of the front and of the rear discs."""

AIR = 20.0
"""Temperature of the air [degC]."""


def heated(time: Array, energy: Array, disc: Disc, start: float = START) -> Array:
    """Temperature of one disc [degC], (n,), that is at ``start`` [degC] at the first sample.

    ``time`` [s]; ``energy`` dissipated in this brake since the first sample [J], (n,), taken as
    linear between samples: what has not yet been lost to the air is E less its own lag. Source:
    Limpert, Brake Design and Safety, ch. 3, for the lumped disc.
    The pads take no heat, all of the disc has one temperature and the air cools at any speed alike:
    not valid for the surface of the disc within a hard stop, nor over minutes of changing speed.
    """
    kept = energy - first_order(time, energy, disc.cooling_time)
    own = np.exp(-(time - time[0]) / disc.cooling_time)
    return np.asarray(AIR + (start - AIR) * own + kept / disc.heat_capacity)

"""The force balance of a run, and what its brakes would do with nominal pads."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.car.balance import ForceBalance, brake_forces, force_balance
from calib.car.braking import BITE
from calib.car.effects.effects import Effects
from calib.car.vehicle import Vehicle
from calib.run.axle_signals import Signals

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


@dataclass(frozen=True)
class BrakeBalance:
    """Forces of a run [N], shapes (n,).

    ``nominal_f``, ``nominal_r`` brake forces of nominal pads; ``balance`` all others; ``active``
    where the pads bite, after the lead-in.
    """

    nominal_f: Array
    nominal_r: Array
    balance: ForceBalance
    active: Mask


def brake_balance(car: Vehicle, effects: Effects, s: Signals) -> BrakeBalance:
    """Balance of a run with the nominal pads of ``car`` and the known effects."""
    nominal_f, nominal_r = brake_forces(car, s.p_f, s.p_r)
    drive = (s.drive_f, s.drive_r)
    return BrakeBalance(
        nominal_f=nominal_f,
        nominal_r=nominal_r,
        balance=force_balance(car, effects, s.time, s.speed, s.z, s.p_f, drive),
        active=_began(s) & (np.maximum(s.p_f, s.p_r) > BITE),
    )


def _began(s: Signals) -> Mask:
    """From the end of the lead-in on; all along without one."""
    return np.asarray(~np.logical_or.accumulate(s.lead_in[::-1])[::-1])

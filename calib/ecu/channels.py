"""What an ECU reads and answers: the one order of both, in Python, in C and in an FMU."""

import math
from typing import NamedTuple

import numpy as np

from calib.base.arrays import Array
from calib.base.names import AXLE_NAMES, WHEELS
from calib.logs.log import Log


class Channel(NamedTuple):
    """A sensor [SI]: the ``low`` and ``high`` end of what it reads while it works.

    From sample to sample it changes by ``jump`` and ``rate`` times their distance in time [s] at
    most; what changes by more is an error of the bus.
    """

    unit: str
    meaning: str
    low: float
    high: float
    jump: float = math.inf
    rate: float = 0.0


_UNKNOWN = "0 where nobody knows"
CHANNELS = {
    "p_mc": Channel("Pa", "Pressure of the master cylinder", -1e6, 4e7, 1e7),
    "a_x": Channel("m/s2", "Specific force at the center of gravity, forward positive: braking is "
        "negative", -30.0, 30.0, 15.0),
    **{f"omega_{w}": Channel("rad/s", f"Speed of wheel {w}", -50.0, 500.0, 5.0, 5e3)
        for w in WHEELS},
    "steering": Channel("rad", f"Angle at the driver's wheel; {_UNKNOWN}", -50.0, 50.0),
    "driven": Channel("1", f"1 while the accelerator is pressed; {_UNKNOWN}", 0.0, 1.0),
    **{f"T_drive_{axle}": Channel("N.m", f"Torque of engine or motor at both {name} wheels, "
        f"negative where it slows; {_UNKNOWN}", -2e4, 2e4) for axle, name in AXLE_NAMES.items()},
}  # fmt: skip
"""What an ECU reads at one time; a sample (10,) has this order, in Python and in C."""

P_MC, A_X, FL, FR, RL, RR, STEERING, DRIVEN, *_ = range(len(CHANNELS))
OMEGA, DRIVE = slice(FL, RR + 1), slice(DRIVEN + 1, None)

ANSWERS = {
    "level": ("1", "Brake torque over that of the vehicle file's pads"),
    "ratio": ("1", "Friction of the front pads over that of the rear ones"),
    **{f"pad_friction_{a}": ("1", f"Friction of the {at} pads") for a, at in AXLE_NAMES.items()},
    **{f"brake_torque_{a}": ("N.m", f"Torque of one {at} brake") for a, at in AXLE_NAMES.items()},
    "brake_torque_sum": ("N.m", "Torque of all brakes"),
}
"""What is answered, with unit and meaning: (7, 3), each a median with its 95 % bounds."""


def samples_of(log: Log) -> Array:
    """What an ECU would read in a log (n, 10), by `CHANNELS`."""
    nothing = np.zeros_like(log.time)
    return np.stack([log.channels.get(name, nothing) for name in CHANNELS], axis=1)


def limits(sample_time: float) -> tuple[Array, Array, Array]:
    """Low and high ends and largest changes of `CHANNELS` (10,) between calls [s]."""
    rows = [
        (c.low, c.high, min(c.jump + c.rate * sample_time, c.high - c.low))
        for c in CHANNELS.values()
    ]
    low, high, jump = np.array(rows).T
    return low, high, jump

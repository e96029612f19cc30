"""Why an answer does not stand: the reasons of the step, and those that its signals alone show."""

from enum import IntEnum

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.names import WHEELS
from calib.car.braking import MOVING
from calib.logs.log import Log
from calib.run.axle_signals import Signals
from calib.run.driving_record import NOMINAL_RADIUS
from calib.run.filters import since, without_single


class Reason(IntEnum):
    """Why the answer of a block does not stand: the first that applies; 0 for one that does.

    It says that the model does not hold, never that an interval is wide.
    """

    words: str

    def __new__(cls, value: int, words: str) -> "Reason":
        """A number with its ``words``."""
        one = int.__new__(cls, value)
        one._value_, one.words = value, words
        return one

    VALID = 0, "it stands"
    NOT_BRAKED = 1, "the pressure is low"
    TURNED = 2, "the wheel is turned"
    CORNERS = 3, "the car corners"
    LOCKED = 4, "a wheel locks, or ABS works"
    SLOW = 5, "the car is slow"
    JUST_APPLIED = 6, "the brake has just been applied"
    NO_PAD = 7, "no pad has such a friction"
    BEYOND_MAP = 8, "no stop that the table knows shows such an eta"
    FAULT = 9, "a sensor is out of its range or frozen"


STEERING = float(np.deg2rad(5.0))
"""Angle at the driver's wheel [rad] whose effect on eta is as large as the signal."""
LATERAL = 3.0
"""Lateral acceleration [m/s^2] by left and right wheel speeds past which cornering tyres leave the
curve; radii 0.5 % apart, left to right, look like as much at 30 m/s."""
LOCK = 0.15
"""Relative departure of a wheel from the others that only ABS or a locked wheel shows."""
HARDEST = 15.0
"""Deceleration [m/s^2] that no road lets a car have: wheels that slow more lock, all four too."""
RECOVER = 1.0
"""Time after such a departure [s]: the filters behind the signals have forgotten it."""


def disturbances(log: Log, s: Signals, cornering: Array) -> Index:
    """A `Reason` for each sample (n,) in which the car is steered or a wheel locks, or just has.

    0 where neither is so. ``cornering`` the lateral acceleration [m/s^2] (n,).
    """
    steered = log["steering"] if "steering" in log else np.zeros_like(s.time)
    return disturbed(since(s.time, _locks(log, s)) <= RECOVER, cornering, steered)


def disturbed(locked: Mask | bool, cornering: Array | float, steered: Array | float) -> Index:
    """A `Reason`, or 0, by whether a wheel locks or just has, and by what corners and steers."""
    with np.errstate(invalid="ignore"):
        corners, turned = ~(np.abs(cornering) < LATERAL), ~(np.abs(steered) < STEERING)
    told = np.where(corners, Reason.CORNERS, np.where(turned, Reason.TURNED, 0))
    return np.where(locked, Reason.LOCKED, told)


def _locks(log: Log, s: Signals) -> Mask:
    """Where a wheel departs from the others, or from v, as only ABS or a locked wheel does."""
    wheels = np.stack([without_single(log[f"omega_{w}"]) for w in WHEELS])
    fastest = wheels.max(axis=0)
    if s.v is not None and s.lead_in.any():  # all four may lock together
        per_speed = float(np.mean(fastest[s.lead_in]) / np.mean(s.v[s.lead_in]))
        fastest = np.maximum(fastest, per_speed * s.v)
    return locks(s.time, fastest, wheels.min(axis=0))


def locks(time: Array, fastest: Array, slowest: Array) -> Mask:
    """Whether wheels [rad/s] (n,) depart from each other as only ABS or a locked wheel does.

    The fastest one, too, may slow as no road lets a car slow. ``time`` [s] (n,).
    """
    slows = HARDEST / NOMINAL_RADIUS * time
    fastest = np.maximum.accumulate(fastest + slows) - slows
    apart = fastest - slowest > LOCK * np.maximum(fastest, 1.0)
    return np.asarray(apart & (fastest > MOVING / NOMINAL_RADIUS))

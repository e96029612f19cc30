"""Reasons why an answer is not valid, and the reasons that signals give: bends, locks and ABS."""

from enum import IntEnum

import numpy as np

from calib.base.arrays import Array, Index, Mask
from calib.base.names import WHEELS
from calib.estimation.constants import Constants
from calib.logs.log import Log
from calib.run.axle_signals import Signals
from calib.run.filters import median_of_three, time_since
from calib.run.lateral import lateral
from calib.table.table import Table


class Reason(IntEnum):
    """Why the model does not hold in a block, so that its answer is not valid; 0 if it is valid."""

    words: str  # the second half of each member

    def __new__(cls, value: int, words: str) -> "Reason":
        """Return the number ``value`` with its ``words``."""
        member = int.__new__(cls, value)
        member._value_, member.words = value, words
        return member

    VALID = 0, "the answer is valid"
    NOT_BRAKED = 1, "the pressure is low"
    TURNED = 2, "the steering wheel is turned"
    CORNERS = 3, "the car corners"
    LOCKED = 4, "a wheel locks, or ABS works"
    SLOW = 5, "the car is slow"
    JUST_APPLIED = 6, "the brake has just been applied"
    NO_PAD = 7, "no pad has such a friction"
    BEYOND_MAP = 8, "no stop that the table knows shows such an eta"
    FAULT = 9, "a sensor is out of its range, or jumps"
    IMPLAUSIBLE = 10, "what is measured is not what the model predicts"
    ABS = 11, "ABS or ESC act, or just have"


CHECKS = {
    "a_x_changed": "a_x changes, and the wheels do not",
    "motor_changed": "the torque of a motor changes, and the car does not",
    "modulated": "the force changes all the time at a held pressure, as with ABS",
    "far": "the learned errors of a_x, or the demanded force, are larger than on any car",
    "no_zero": "the readings while nothing brakes are too far off for zeros",
}
"""Checks of innovations and states, with words for a failure; their bits are 1, 2, 4, 8 and 16."""


def disturbances(table: Table, log: Log, s: Signals) -> Index:
    """Return the `Reason` of each sample (n,) by a bend, a locked wheel or ABS; 0 without any."""
    car, zeros = table.vehicle, np.zeros_like(s.time)
    slip = np.interp(s.z, table.tyre.force, table.tyre.slip)
    return first_reason(
        time_since(s.time, log.channels.get("abs_active", zeros) > 0.5),
        time_since(s.time, _locks(log, s)),
        lateral(log, s, car.track_width, slip=slip, height=car.cg_height),
        log.channels.get("steering", zeros),
        s.sample_time,
    )


def first_reason(
    since_abs: Array | float,
    since_lock: Array | float,
    acceleration: Array | float,
    steering: Array | float,
    sample_time: float,
) -> Index:
    """Return the `Reason` of samples (n,), or of a single one: ABS, else a lock, else a bend.

    ``since_abs`` and ``since_lock`` are times since ABS worked and a wheel locked [s], lateral
    ``acceleration`` is in m/s^2, ``steering`` is the angle of the driver's wheel [rad].
    """
    c, half = Constants, 0.5 * sample_time  # half a sample more, so that no rounding decides
    turned = np.where(np.abs(steering) < c.steering, 0, Reason.TURNED)
    reason = np.where(np.abs(acceleration) >= c.lateral, Reason.CORNERS, turned)
    reason = np.where(since_lock <= c.recover + half, Reason.LOCKED, reason)
    return np.where(since_abs <= c.recover + half, Reason.ABS, reason)


def _locks(log: Log, s: Signals) -> Mask:
    """Return the samples (n,) in which a wheel is slower than the fastest one by `Constants.lock`.

    All four wheels may lock together. So the fastest wheel counts as at least as fast as v says,
    and as slowing by at most `Constants.slows`.
    """
    channels = (log[f"omega_{w}"] for w in WHEELS)
    # (4, n); each sample has the median of the three around the sample before: it is causal
    wheels = np.stack([np.append(x[0], median_of_three(x)[:-1]) for x in channels])
    fastest = wheels.max(axis=0)
    if s.v is not None and s.lead_in.any():
        per_speed = float(np.mean(fastest[s.lead_in]) / np.mean(s.v[s.lead_in]))
        fastest = np.maximum(fastest, per_speed * s.v)
    # the largest of all earlier speeds, each less what wheels can slow since then
    slowed = Constants.slows * np.append(s.time[0], s.time[:-1])
    fastest = np.maximum.accumulate(fastest + slowed) - slowed
    is_slower = fastest - wheels.min(axis=0) > Constants.lock * np.maximum(fastest, 1.0)
    return np.asarray(is_slower & (fastest > Constants.turning))

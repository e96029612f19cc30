"""Front and rear wheel speeds that are exchanged on one side of the car, or over a diagonal.

What braking changes of the four slips s is split into three parts, each 0 but for the first on a
car that brakes alike left and right:

    E = (fl + fr - rl - rr)/2      front against rear: the front wheels slip more
    L = (fl - fr + rl - rr)/2      left against right: a bend, unlike brakes, unlike tyres
    X = (fl - fr - rl + rr)/2      one diagonal against the other

Columns that change places change the parts: fl with rl makes X = -E and E = 0, fr with rr X = E,
fl with rr L = -E, fr with rl L = E. One wheel that brakes more or less moves |X| and |L| alike, so
X alone is no brake and no tyre, and no bend.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calib.base.names import WHEELS
from calib.logs.log import Log
from calib.run.driving_record import DrivingRecord, Mask
from calib.run.filters import block_mean
from calib.run.limits import LIMITS
from calib.run.wheel_checks import IntervalEstimate

Array = NDArray[np.float64]

PARTS = np.array([[1, 1, -1, -1], [1, -1, 1, -1], [1, -1, -1, 1]]) / 2.0
"""E, L and X, each over fl, fr, rl, rr."""

LOW, HIGH = 0.1, 0.5
"""Range of deceleration [1] in which the wheels are compared."""


CORRECT = "compare the columns with the car, and correct them with a channel map"
"""What to do about columns that have changed places."""


@dataclass(frozen=True)
class WheelParts:
    """E, L and X while braking less those of the rolling car [1]; ``z`` mean deceleration [1]."""

    axles: IntervalEstimate
    sides: IntervalEstimate
    diagonals: IntervalEstimate
    z: float


class Crossed(NamedTuple):
    """A front and a rear wheel whose columns have changed places, and the part that tells it [1].

    ``others`` the two wheels that slip less or more than the rest, in words.
    """

    wheels: tuple[str, str]
    part: float
    others: str

    def __str__(self) -> str:
        front, rear = self.wheels
        return (
            f"omega_{front} and omega_{rear} have changed places: while braking {self.others} slip "
            f"{100 * abs(self.part):.2f} % more than the other two, and front and rear alike"
        )


def wheel_parts(log: Log, driving: DrivingRecord) -> WheelParts | None:
    """Compare the wheels; None with fewer than three blocks of 0.2 s that roll, or that brake.

    The interval takes the noise of the rolling car for that of the braking.
    """
    braking = driving.braked & (driving.wheel_z > LOW) & (driving.wheel_z < HIGH)
    braking &= driving.speed > 5.0
    free, braked = (_parts(log, driving, mask) for mask in (driving.unbraked, braking))
    if min(free.shape[1], braked.shape[1]) < 3:
        return None
    from scipy.special import stdtrit

    count = free.shape[1]
    share = np.sqrt(1.0 / count + 1.0 / braked.shape[1])
    half = stdtrit(count - 1, 0.975) * np.std(free, axis=1, ddof=1) * share
    change = np.mean(braked, axis=1) - np.mean(free, axis=1)
    axles, sides, diagonals = (
        IntervalEstimate(float(x), float(h)) for x, h in zip(change, half, strict=True)
    )
    return WheelParts(axles, sides, diagonals, float(np.mean(driving.wheel_z[braking])))


def _parts(log: Log, driving: DrivingRecord, mask: Mask) -> Array:
    """E, L and X of means over `wheel_block` where ``mask`` holds [1], (3, k)."""
    n = max(1, round(LIMITS.wheel_block / driving.step))
    if mask.sum() < n:
        return np.empty((3, 0))
    wheels = np.array([block_mean(log[f"omega_{w}"][mask], n) for w in WHEELS])
    return np.asarray(PARTS @ (1.0 - wheels / wheels.mean(axis=0)))


def crossed_side(parts: WheelParts | None, alone: str | None = None) -> Crossed | None:
    """Front and rear wheel of one side that are exchanged; None where that is not sure.

    ``alone`` is the axle that brakes alone, "f" or "r", or None.
    """
    if parts is None:
        return None
    x = parts.diagonals
    others = max(abs(parts.axles.value), abs(parts.sides.value))
    if abs(x.value) - x.half < max(LIMITS.crossed_alone * others, LIMITS.crossed_least * parts.z):
        return None
    left = (x.value < 0.0) is (alone != "r")
    wheels = ("fl", "rl") if left else ("fr", "rr")
    return Crossed(wheels, x.value, "fl and rr" if x.value > 0.0 else "fr and rl")


def crossed_diagonal(parts: WheelParts | None, expected: float) -> Crossed | None:
    """Front and rear wheel of a diagonal that are exchanged; None where that is not likely.

    ``expected`` is E [1] as the table of the car has it. A bend moves L too, and leaves E.
    """
    if parts is None:
        return None
    part, e, x = parts.sides, abs(parts.axles.value), abs(parts.diagonals.value)
    low, high = abs(expected) / LIMITS.crossed_alone, LIMITS.crossed_alone * abs(expected)
    alone = abs(part.value) - part.half > max(
        LIMITS.crossed_alone * max(e, x), LIMITS.crossed_least * parts.z
    )
    if not (alone and low < abs(part.value) < high and e < low):
        return None
    left = (part.value < 0.0) is (expected > 0.0)
    wheels = ("fl", "rr") if left else ("fr", "rl")
    return Crossed(wheels, part.value, "fl and rl" if part.value > 0.0 else "fr and rr")

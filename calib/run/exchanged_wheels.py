"""Wheels whose columns have changed places, by what braking changes of the four slips.

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

from calib.base.names import WHEELS
from calib.base.warning import LIMITS
from calib.logs.log import Log
from calib.run.driving_record import DrivingRecord
from calib.run.wheels import HIGH, LOW, IntervalEstimate, half_width, wheel_means

_PARTS = np.array([[1, 1, -1, -1], [1, -1, 1, -1], [1, -1, -1, 1]]) / 2.0  # E, L, X over wheels


@dataclass(frozen=True)
class WheelParts:
    """E, L and X while braking less those of the rolling car [1]; ``z`` mean deceleration [1]."""

    axles: IntervalEstimate
    sides: IntervalEstimate
    diagonals: IntervalEstimate
    z: float


class _Crossed(NamedTuple):
    """A front and a rear wheel whose columns are exchanged, and the ``part`` that shows it [1].

    ``others``: the two wheels that slip more than the rest, as text.
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
    """Compare the wheels; None with fewer than three blocks of 0.2 s that roll, or that brake."""
    braking = driving.braked & (driving.wheel_z > LOW) & (driving.wheel_z < HIGH)
    braking &= driving.speed > 5.0
    wheels = np.array([log[f"omega_{w}"] for w in WHEELS])
    means = [wheel_means(wheels, mask, driving.step) for mask in (driving.unbraked, braking)]
    free, braked = (_PARTS @ (1.0 - x / x.mean(axis=0)) for x in means)
    if min(free.shape[1], braked.shape[1]) < 3:
        return None
    change = np.mean(braked, axis=1) - np.mean(free, axis=1)
    half = half_width(free, braked.shape[1])
    axles, sides, diagonals = map(IntervalEstimate, change.tolist(), half.tolist())
    return WheelParts(axles, sides, diagonals, float(np.mean(driving.wheel_z[braking])))


def _alone(part: IntervalEstimate, others: float, z: float) -> bool:
    """Whether X or L exceeds the ``others``, and the effect of unlike brakes at ``z``."""
    least = max(LIMITS.crossed_alone * others, LIMITS.crossed_least * z)
    return bool(abs(part.value) - part.half >= least)


def crossed_side(parts: WheelParts | None, alone: str | None = None) -> _Crossed | None:
    """Exchanged wheels of one side, if sure; ``alone`` the axle that brakes alone, or None."""
    if parts is None:
        return None
    x = parts.diagonals
    if not _alone(x, max(abs(parts.axles.value), abs(parts.sides.value)), parts.z):
        return None
    wheels = ("fl", "rl") if (x.value < 0.0) is (alone != "r") else ("fr", "rr")
    return _Crossed(wheels, x.value, "fl and rr" if x.value > 0.0 else "fr and rl")


def crossed_diagonal(parts: WheelParts | None, expected: float) -> _Crossed | None:
    """Exchanged wheels of a diagonal, if likely; ``expected`` E [1] by the table of the car.

    A bend changes L too, but not E.
    """
    if parts is None:
        return None
    part, e, x = parts.sides, abs(parts.axles.value), abs(parts.diagonals.value)
    low, high = abs(expected) / LIMITS.crossed_alone, LIMITS.crossed_alone * abs(expected)
    if not (_alone(part, max(e, x), parts.z) and low < abs(part.value) < high and e < low):
        return None
    wheels = ("fl", "rr") if (part.value < 0.0) is (expected > 0.0) else ("fr", "rl")
    return _Crossed(wheels, part.value, "fl and rl" if part.value > 0.0 else "fr and rr")

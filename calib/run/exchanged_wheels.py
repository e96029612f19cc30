"""Find wheels whose columns have changed places, by the change of the four slips in a braking.

The change of the four slips, fl to rr, is split into three parts. On a car that brakes alike left
and right only E is not zero:

    E = (fl + fr - rl - rr)/2      front against rear: the front wheels slip more
    L = (fl - fr + rl - rr)/2      left against right: a bend, unlike brakes, unlike tyres
    X = (fl - fr - rl + rr)/2      one diagonal against the other

Columns that change places move the E of the car to another part, with this sign:

    fl with rl: X = -E      fr with rr: X = E      exchanged on one side
    fl with rr: L = -E      fr with rl: L = E      exchanged on a diagonal

One wheel that brakes more or less changes |X| and |L| alike, and a bend only L. So a large X with a
small L shows columns exchanged on one side.
"""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from calib.base.names import WHEELS
from calib.base.warning import LIMITS
from calib.logs.log import Log
from calib.run.driving_record import DrivingRecord
from calib.run.wheels import HIGH, LOW, IntervalEstimate, half_width, wheel_means

_PARTS = np.array([[1, 1, -1, -1], [1, -1, 1, -1], [1, -1, -1, 1]]) / 2.0  # of E, L and X


@dataclass(frozen=True)
class WheelParts:
    """The parts of the change by braking [1], and the mean deceleration of the braking [1]."""

    axles: IntervalEstimate  # E
    sides: IntervalEstimate  # L
    diagonals: IntervalEstimate  # X
    z: float


class _Crossed(NamedTuple):
    """A front and a rear wheel whose columns are exchanged."""

    wheels: tuple[str, str]
    part: float  # the X or L that shows the exchange [1]
    slipping: str  # names of the two wheels that slip more

    def __str__(self) -> str:
        front, rear = self.wheels
        return (
            f"omega_{front} and omega_{rear} have changed places: while braking {self.slipping} "
            f"slip {100 * abs(self.part):.2f} % more than the other two, and front and rear alike"
        )


def wheel_parts(log: Log, driving: DrivingRecord) -> WheelParts | None:
    """Compute E, L and X; None with fewer than three blocks of 0.2 s that roll, or that brake."""
    braking = driving.braked & (driving.wheel_z > LOW) & (driving.wheel_z < HIGH)
    braking &= driving.speed > 5.0
    wheels = np.array([log[f"omega_{w}"] for w in WHEELS])
    means = [wheel_means(wheels, mask, driving.step) for mask in (driving.unbraked, braking)]
    # parts (3, k) of the slips against the mean wheel; the speed of the car cancels in each part
    rolling, braked = (_PARTS @ (1.0 - x / x.mean(axis=0)) for x in means)
    if min(rolling.shape[1], braked.shape[1]) < 3:
        return None
    change = np.mean(braked, axis=1) - np.mean(rolling, axis=1)
    half = half_width(rolling, braked.shape[1])
    axles, sides, diagonals = map(IntervalEstimate, change.tolist(), half.tolist())
    return WheelParts(axles, sides, diagonals, float(np.mean(driving.wheel_z[braking])))


def _stands_alone(part: IntervalEstimate, others: tuple[float, float], z: float) -> bool:
    """Whether X or L exceeds the ``others`` by far, and what unlike brakes make at ``z`` [1]."""
    least = max(LIMITS.crossed_alone * max(map(abs, others)), LIMITS.crossed_least * z)
    return bool(abs(part.value) - part.half >= least)


def crossed_side(parts: WheelParts | None, alone: str | None = None) -> _Crossed | None:
    """Return the exchanged wheels of one side if X shows them; ``alone`` is the one braked axle."""
    if parts is None:
        return None
    x = parts.diagonals
    if not _stands_alone(x, (parts.axles.value, parts.sides.value), parts.z):
        return None
    sign_of_e = -1.0 if alone == "r" else 1.0  # if the rear axle brakes alone, E is negative
    wheels = ("fl", "rl") if x.value * sign_of_e < 0.0 else ("fr", "rr")
    return _Crossed(wheels, x.value, "fl and rr" if x.value > 0.0 else "fr and rl")


def crossed_diagonal(parts: WheelParts | None, expected: float) -> _Crossed | None:
    """Return the exchanged wheels of a diagonal if L likely shows them.

    L must be of the size of the E [1] that is ``expected`` by the table of the car, and E much
    smaller: a bend changes L, too, but not E.
    """
    if parts is None:
        return None
    left_right, e = parts.sides, parts.axles.value
    low, high = abs(expected) / LIMITS.crossed_alone, LIMITS.crossed_alone * abs(expected)
    if not (low < abs(left_right.value) < high and abs(e) < low):
        return None
    if not _stands_alone(left_right, (e, parts.diagonals.value), parts.z):
        return None
    wheels = ("fl", "rr") if left_right.value * expected < 0.0 else ("fr", "rl")
    slipping = "fl and rl" if left_right.value > 0.0 else "fr and rr"
    return _Crossed(wheels, left_right.value, slipping)

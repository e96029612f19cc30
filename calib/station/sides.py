"""Left against right: how much harder one brake of an axle grips than its twin.

slip of each wheel, zeroed on the unbraked part, (20) --> the tyre curve g of the table
d = (g(s_l) - g(s_r)) / mean: left and right carry the same load on a straight, level road

Needs a reference speed. A bend or a crowned road looks the same as a difference of the brakes.
"""

import numpy as np
from numpy.typing import NDArray

from calib.checks.wheel_checks import BLOCK, IntervalEstimate
from calib.logs.log import Log
from calib.physics.braking import MOVING
from calib.physics.forces import slip
from calib.signals.driving_record import DrivingRecord, driving_record
from calib.signals.filters import block_mean
from calib.table.table import Table, TyreCurve

Array = NDArray[np.float64]

LOW, HIGH = 0.10, 0.40
"""Deceleration [1] between which it is read: below slip is lost in noise, above the tyre bends."""

WIDEST = 0.05
"""Half width of the 95 % interval [1] beyond which the difference counts as not known."""

FEWEST = 8
"""Blocks of 0.2 s below which a scatter says nothing."""


def side_difference(table: Table, log: Log, axle: str) -> IntervalEstimate | None:
    """Brake force left less right over their mean [1], of ``axle`` "f" or "r".

    Where the log knows both pressures of the axle their difference is taken out, so that what is
    left is that of the pads. Moments in which a wheel slips beyond the end of the tyre curve are
    left out: the table knows no force there. None where the log cannot tell: no reference speed,
    too little braking between 0.1 and 0.4 g within the curve, or an interval wider than
    +-``WIDEST``.
    """
    if "v" not in log:
        return None
    driving = driving_record(log)
    slips = [_slip(table, log, driving, f"{axle}{side}") for side in "lr"]
    free = [_means(s, driving.unbraked, driving) for s in slips]
    use = driving.braked & (driving.z > LOW) & (driving.z < HIGH) & (driving.speed > MOVING)
    if free[0].size < 3:
        return None
    left, right = (
        _means(s, use, driving) - np.mean(zero) for s, zero in zip(slips, free, strict=True)
    )
    known = np.maximum(left, right) <= table.tyre.slip[-1]
    if np.count_nonzero(known) < FEWEST:
        return None
    F_l, F_r = (_force(table.tyre, s[known]) for s in (left, right))
    stiffness = float(table.tyre.force[1] / table.tyre.slip[1])
    found = _slope(0.5 * (F_l + F_r), F_l - F_r, stiffness * (free[0] - free[1]))
    if found is None or found.half > WIDEST:
        return None
    return IntervalEstimate(found.value - _pressures(log, axle, use), found.half)


def _slip(table: Table, log: Log, driving: DrivingRecord, wheel: str) -> Array:
    """Slip of one wheel [1] (n,), (19), (20), not zeroed."""
    of = table.vehicle.front if wheel[0] == "f" else table.vehicle.rear
    return slip(of, log[f"omega_{wheel}"], np.maximum(log["v"], 1.0))


def _means(x: Array, mask: NDArray[np.bool_], driving: DrivingRecord) -> Array:
    n = max(1, round(BLOCK / driving.step))
    return block_mean(x[mask], n)


def _force(tyre: TyreCurve, s: Array) -> Array:
    """Normalised force [1] of the tyre curve at slip ``s``; odd, as noise about nought is."""
    return np.asarray(np.sign(s) * np.interp(np.abs(s), tyre.slip, tyre.force))


def _slope(x: Array, y: Array, free: Array) -> IntervalEstimate | None:
    """Slope of y = d x through nought, its interval with that of the zero of ``free``."""
    power = float(x @ x)
    if power == 0.0:
        return None
    from scipy.special import stdtrit

    slope = float(x @ y) / power
    spread = float(np.std(y - slope * x, ddof=1)) / np.sqrt(power)
    zero = float(np.std(free, ddof=1)) / np.sqrt(free.size) * abs(float(np.sum(x))) / power
    return IntervalEstimate(
        slope, float(stdtrit(y.size - 1, 0.975)) * float(np.hypot(spread, zero))
    )


def _pressures(log: Log, axle: str, use: NDArray[np.bool_]) -> float:
    """Left less right over their mean of the wheel pressures [1]; nought where not logged."""
    if f"p_{axle}l" not in log or f"p_{axle}r" not in log:
        return 0.0
    left, right = (float(np.mean(log[f"p_{axle}{side}"][use])) for side in "lr")
    return 2.0 * (left - right) / (left + right) if left + right > 0.0 else 0.0

"""Left against right: the difference of the two brakes of an axle.

slip of each wheel, zeroed on the unbraked part, (20) --> the tyre curve g of the table
d = (g(s_l) - g(s_r)) / mean: left and right carry the same load on a straight, level road

Needs a reference speed. A bend or a crowned road looks the same as a difference of the brakes.
"""

import numpy as np
from numpy.typing import NDArray

from calib.car.braking import MOVING
from calib.car.forces import slip
from calib.logs.log import Log
from calib.run.driving_record import DrivingRecord, driving_record
from calib.run.filters import block_mean
from calib.run.limits import LIMITS
from calib.run.wheels import IntervalEstimate
from calib.table.table import Table, TyreCurve

Array = NDArray[np.float64]

LOW, HIGH = 0.10, 0.40
"""Range of deceleration [1]: below it noise is too large, above it the tyre curve is not linear."""

WIDEST = 0.05
"""Half width of the 95 % interval [1] above which the difference counts as not known."""

FEWEST = 8
"""Least number of blocks of 0.2 s for an estimate of the scatter."""


def side_difference(table: Table, log: Log, axle: str) -> IntervalEstimate | None:
    """Brake force left less right over their mean [1], of ``axle`` "f" or "r".

    Where the log has both pressures of the axle, their difference is subtracted, so that the rest
    is that of the pads. Samples in which a wheel slips beyond the end of the tyre curve are left
    out: the table has no force there. None where the log has no reference speed, too little
    braking between 0.1 and 0.4 g within the curve, or gives an interval wider than +-``WIDEST``.
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
    n = max(1, round(LIMITS.wheel_block / driving.step))
    return block_mean(x[mask], n)


def _force(tyre: TyreCurve, s: Array) -> Array:
    """Normalised force [1] of the tyre curve at slip ``s``; odd, for noise about zero."""
    return np.asarray(np.sign(s) * np.interp(np.abs(s), tyre.slip, tyre.force))


def _slope(x: Array, y: Array, free: Array) -> IntervalEstimate | None:
    """Slope d of y = d x with its 95 % interval, which includes that of the zero of ``free``."""
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
    """Left less right over their mean of the wheel pressures [1]; zero where not logged."""
    if f"p_{axle}l" not in log or f"p_{axle}r" not in log:
        return 0.0
    left, right = (float(np.mean(log[f"p_{axle}{side}"][use])) for side in "lr")
    return 2.0 * (left - right) / (left + right) if left + right > 0.0 else 0.0

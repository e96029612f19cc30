"""The metrics of a car as a whole; those of each hold-out are in `calib.estimation.metrics`."""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
from calib.base.plain import limit_of, meanings
from calib.base.warning import LIMITS
from calib.car.balance import front_biased_up_to
from calib.car.braking import MOVING
from calib.car.forces import slip
from calib.estimation.agreement import agreement
from calib.estimation.validate import Validation
from calib.line.station.golden import golden_metrics
from calib.logs.log import Log
from calib.run.filters import block_mean, samples_in
from calib.run.run import Run
from calib.table.curves import MEASURED
from calib.table.table import Table

METRICS: dict[str, str] = meanings("car")
"""Every metric of the car, with its meaning."""

_LOW, _HIGH = 0.10, 0.40
"""Range of deceleration [1] for left and right: too much noise below, a nonlinear tyre above."""
_WIDEST = 0.05
"""Half width of the 95 % interval [1] above which a side difference is not known."""
_FEWEST = 8
"""Least number of blocks of 0.2 s for an estimate of the scatter."""


def metrics_of(
    table: Table, ramps: Sequence[Log], results: Sequence[Validation], golden: Table | None = None
) -> dict[str, float | None]:
    """All `METRICS` of a car; None where its logs cannot give one.

    ``ramps`` the logs that ``table`` was fitted on, without coasts; ``results`` of its hold-outs;
    ``golden`` the table of its model.
    """
    cal, runs = table.calibration, [Run(log) for log in ramps]
    car = table.vehicle.with_pads(cal.pad_friction_f.value, cal.pad_friction_r.value)
    zeros = [run.axles.front_rear for run in runs if run.axles]
    mismatches = [table.vehicle.radius_mismatch(zero.value) for zero in zeros if zero]
    out: dict[str, float | None] = {
        "ramp_deceleration": table.quality["deceleration_max"],
        "measured_share": float(np.mean(table.paper.flag == MEASURED)),
        "band_width": table.difference.band_width,
        "ramp_eta_zero": _largest(mismatches),
        "pad_scale": cal.pad_scale.value,
        "pad_ratio": float(np.exp(cal.pad_log_ratio.value)),
        # The cut stands for everything above it.
        "front_biased_up_to": min(front_biased_up_to(car), limit_of("front_biased_up_to", "cut")),
    }
    for axle in "fr":
        sides = [side_difference(table, run, axle) for run in runs]
        out[f"side_difference_{axle}"] = _largest(sides)
    if together := agreement(results):
        out["repeatability_f"] = together.largest_departure_f
        out["repeatability_r"] = together.largest_departure_r
    if golden:
        out |= golden_metrics(table, golden)
    return {name: out.get(name) for name in METRICS}


def _largest(values: Sequence[float | None]) -> float | None:
    """The value of largest magnitude, with its sign."""
    return max((v for v in values if v is not None), key=abs, default=None)


def side_difference(table: Table, run: Run, axle: str) -> float | None:
    """Brake force left less right over their mean [1], of ``axle`` "f" or "r".

    slip of each wheel, zeroed on the unbraked part, (20) --> the tyre curve g of the table
    d = (g(s_l) - g(s_r)) / mean: left and right carry the same load on a straight, level road

    Where the log has both pressures of the axle, their difference is subtracted, so that d is that
    of the pads. None without a reference speed, with too little braking between 0.1 and 0.4 g, or
    an interval wider than +-`_WIDEST`. A bend or a crowned road looks like a difference.
    """
    log, driving = run.log, run.driving
    if "v" not in log:
        return None
    wheel = table.vehicle.front if axle == "f" else table.vehicle.rear
    speed = np.maximum(log["v"], 1.0)
    slips = [slip(wheel, log[f"omega_{axle}{side}"], speed) for side in "lr"]
    block = samples_in(LIMITS.wheel_block, driving.step)
    free = [block_mean(s[driving.unbraked], block) for s in slips]
    if free[0].size < 3:
        return None
    use = driving.braked & (driving.z > _LOW) & (driving.z < _HIGH) & (driving.speed > MOVING)
    slipping = [
        block_mean(s[use], block) - np.mean(zero) for s, zero in zip(slips, free, strict=True)
    ]
    tyre = table.tyre
    on_curve = np.maximum(*slipping) <= tyre.slip[-1]
    if np.count_nonzero(on_curve) < _FEWEST:
        return None
    # the curve is odd, for noise about zero
    F_l, F_r = (
        np.sign(s) * np.interp(np.abs(s), tyre.slip, tyre.force)
        for s in (x[on_curve] for x in slipping)
    )
    stiffness = float(tyre.force[1] / tyre.slip[1])
    d, half = _slope(0.5 * (F_l + F_r), F_l - F_r, stiffness * (free[0] - free[1]))
    return d - _pressures(log, axle, use) if half <= _WIDEST else None


def _slope(x: Array, y: Array, free: Array) -> tuple[float, float]:
    """Slope d of y = d x, and the half width of its 95 % interval.

    It includes the error of the zero, which is estimated from ``free``, the y of unbraked rolling.
    """
    from scipy.special import stdtrit

    power = float(x @ x)
    if power == 0.0:
        return 0.0, np.inf
    d = float(x @ y) / power
    spread = float(np.std(y - d * x, ddof=1)) / np.sqrt(power)
    zero = float(np.std(free, ddof=1)) / np.sqrt(free.size) * abs(float(np.sum(x))) / power
    return d, float(stdtrit(y.size - 1, 0.975)) * float(np.hypot(spread, zero))


def _pressures(log: Log, axle: str, use: NDArray[np.bool_]) -> float:
    """Left less right over their mean of the wheel pressures [1]; zero where not logged."""
    if f"p_{axle}l" not in log or f"p_{axle}r" not in log:
        return 0.0
    left, right = (float(np.mean(log[f"p_{axle}{side}"][use])) for side in "lr")
    return 2.0 * (left - right) / (left + right) if left + right > 0.0 else 0.0

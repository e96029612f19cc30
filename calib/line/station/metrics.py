"""Metrics of a car as a whole. Those of a single hold-out are in `calib.estimation.metrics`.

`metrics_of` returns all of them. The rest of the file is the side difference, left against right.
"""

from collections.abc import Sequence

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.plain import meanings, metric_of
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

METRICS: dict[str, str] = meanings("car")  # the metrics of a car, with their meanings
_LOW, _HIGH = 0.10, 0.40  # deceleration [1]: too noisy below, nonlinear tyres above
_WIDEST = 0.05  # half width of the 95 % interval [1] above which a side difference is not known
_FEWEST = 8  # least number of blocks of 0.2 s for an estimate of the scatter


def metrics_of(
    table: Table, ramps: Sequence[Log], results: Sequence[Validation], golden: Table | None = None
) -> dict[str, float | None]:
    """Return all `METRICS` of a car; None where its logs cannot give a metric.

    ``ramps`` are those of the fit of ``table``, ``golden`` is the golden table of the model.
    """
    pads, runs = table.calibration, [Run(log) for log in ramps]
    car = table.vehicle.with_pads(pads.pad_friction_f.value, pads.pad_friction_r.value)
    eta_zeros = [run.axles.front_rear for run in runs if run.axles]  # eta - 1 without brakes
    mismatches = [table.vehicle.radius_mismatch(zero.value) for zero in eta_zeros if zero]
    largest_z = metric_of("front_biased_up_to").cut  # this value stands for all larger ones
    metrics: dict[str, float | None] = {
        "ramp_deceleration": table.quality["deceleration_max"],
        "measured_share": float(np.mean(table.paper.flag == MEASURED)),
        "band_width": table.difference.band_width,
        "ramp_eta_zero": _largest(mismatches),
        "pad_scale": pads.pad_scale.value,
        "pad_ratio": float(np.exp(pads.pad_log_ratio.value)),
        "front_biased_up_to": min(front_biased_up_to(car), largest_z),
    }
    for axle in "fr":
        differences = [side_difference(table, run, axle) for run in runs]
        metrics[f"side_difference_{axle}"] = _largest(differences)
    between_stops = agreement(results)
    if between_stops:
        metrics["repeatability_f"] = between_stops.largest_departure_f
        metrics["repeatability_r"] = between_stops.largest_departure_r
    if golden:
        metrics |= golden_metrics(table, golden)
    return {name: metrics.get(name) for name in METRICS}


def _largest(values: Sequence[float | None]) -> float | None:
    """Return the value of largest magnitude with its sign, None without a value."""
    return max((value for value in values if value is not None), key=abs, default=None)


def side_difference(table: Table, run: Run, axle: str) -> float | None:
    """Return the brake force left less right over the mean of both [1], of ``axle`` "f" or "r".

    The slip s of each wheel (20), less its mean on the unbraked part, gives the force g(s) by the
    tyre curve of the table. On a straight, level road left and right carry the same load, so

        F_l - F_r = d (F_l + F_r)/2        F = g(s), d is the difference

    Where the log has both pressures of the axle, their difference is subtracted, so that only that
    of the pads remains. The result is None without a reference speed, with too little braking from
    0.1 to 0.4 g, or if the half width of the 95 % interval is above `_WIDEST`. A bend or a crowned
    road looks like a difference.
    """
    log, driving = run.log, run.driving
    if "v" not in log:
        return None
    wheel = table.vehicle.front if axle == "f" else table.vehicle.rear
    speed = np.maximum(log["v"], 1.0)  # no division by zero at rest [m/s]
    slips = [slip(wheel, log[f"omega_{axle}{side}"], speed) for side in "lr"]
    block = samples_in(LIMITS.wheel_block, driving.step)
    rolling = [block_mean(s[driving.unbraked], block) for s in slips]
    if rolling[0].size < 3:  # too few blocks for the scatter of the zero
        return None
    use = driving.braked & (driving.z > _LOW) & (driving.z < _HIGH) & (driving.speed > MOVING)
    zeros = [np.mean(s) for s in rolling]
    s_l, s_r = (block_mean(s[use], block) - zero for s, zero in zip(slips, zeros, strict=True))
    tyre = table.tyre
    on_curve = np.maximum(s_l, s_r) <= tyre.slip[-1]
    if np.count_nonzero(on_curve) < _FEWEST:
        return None
    # noise may make a small slip negative: the curve is continued as an odd function
    s = np.stack([s_l, s_r])[:, on_curve]
    F_l, F_r = np.sign(s) * np.interp(np.abs(s), tyre.slip, tyre.force)
    # F_l - F_r without brakes: its scatter is the error of the zero
    rolling_difference = float(tyre.force[1] / tyre.slip[1]) * (rolling[0] - rolling[1])
    d, half_width = _slope(0.5 * (F_l + F_r), F_l - F_r, rolling_difference)
    return d - _pressure_difference(log, axle, use) if half_width <= _WIDEST else None


def _slope(x: Array, y: Array, y_rolling: Array) -> tuple[float, float]:
    """Return the slope d of y = d x, and the half width of its 95 % interval."""
    from scipy.special import stdtrit

    sum_of_squares = float(x @ x)
    if sum_of_squares == 0.0:
        return 0.0, np.inf
    d = float(x @ y) / sum_of_squares
    of_noise = float(np.std(y - d * x, ddof=1)) / np.sqrt(sum_of_squares)
    zero = float(np.std(y_rolling, ddof=1)) / np.sqrt(y_rolling.size)  # error of the zero of y
    of_zero = zero * abs(float(np.sum(x))) / sum_of_squares
    return d, float(stdtrit(y.size - 1, 0.975)) * float(np.hypot(of_noise, of_zero))


def _pressure_difference(log: Log, axle: str, use: Mask) -> float:
    """Return the wheel pressure left less right over their mean [1]; zero without pressures."""
    if f"p_{axle}l" not in log or f"p_{axle}r" not in log:
        return 0.0
    left, right = (float(np.mean(log[f"p_{axle}{side}"][use])) for side in "lr")
    return 2.0 * (left - right) / (left + right) if left + right > 0.0 else 0.0

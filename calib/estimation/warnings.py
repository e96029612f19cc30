"""What speaks against an estimate although it is valid: the likely sensor or part, by name."""

import math
from collections.abc import Iterator

import numpy as np

from calib.base.intervals import Z95
from calib.base.warning import PlausibilityWarning, judged
from calib.car.bias import front_share
from calib.estimation.estimator import Estimate
from calib.estimation.known import known_resistance
from calib.estimation.limits import Judgement
from calib.estimation.metrics import METRICS
from calib.logs.log import Log
from calib.model.sensors import judge_accelerometer
from calib.plausibility.pads import of_changes
from calib.plausibility.run import run_warnings
from calib.run.brake_response import brake_response
from calib.table.budget import level_of


def warnings_of(log: Log, e: Estimate) -> tuple[PlausibilityWarning, ...]:
    """Warnings on one log, from what its whole run says."""
    sensor = judge_accelerometer(e.car, known_resistance(e.table), e.blocks, e.noise)
    of_run = run_warnings(log, e.read, e.car, sensor, brake_response(e.read, e.forces))
    if not e.valid.any():
        return of_run
    return (*of_run, *judged(log.name, of_changes(pads_together(e), pads_apart(e))))


def limit_warnings(log: str, limits: tuple[Judgement, ...]) -> Iterator[PlausibilityWarning]:
    """A warning for each metric that passes and lies outside the range without warning."""
    for one in limits:
        if one.warned and one.value is not None:
            yield PlausibilityWarning(
                one.figure,
                log,
                one.value,
                (one.warn_low, one.warn_high),
                (f"a stop, a sensor or pads that are not as usual: {METRICS[one.figure]}",),
                "look at this stop with `brake-cal check` and `brake-cal plot`",
            )


def pads_apart(e: Estimate) -> tuple[float, float]:
    """ln of the front pads' change over the rear ones', at the last valid sample; its sigma."""
    middle, low, high = e.best.step.change[:, _last(e)].tolist()
    return middle, (high - low) / (2.0 * Z95)


def pads_together(e: Estimate) -> tuple[float, float]:
    """ln of the brake force over that of the ramp's pads, at the last valid sample; its sigma.

    The mass is not counted in the sigma, since another load is what it would tell.
    """
    last, best = _last(e), e.best
    share = front_share(e.table.vehicle, e.table.calibration.pad_log_ratio.value)
    level = share * best.change_f.value[last] + (1.0 - share) * best.change_r.value[last]
    z = max(float(e.read.z[last]), 0.02)
    speed = e.read.speed[last : last + 1]
    resistance = float(known_resistance(e.table).sigma_z(e.car, speed)[0]) / z
    sensors = float(best.step.noise[last] + best.step.accelerometer[last])
    ramp = sum(variance for part, variance in level_of(e.table).items() if part != "mass")
    return math.log(level), math.sqrt(sensors + resistance**2 + ramp)


def _last(e: Estimate) -> int:
    """The last valid sample."""
    return int(np.flatnonzero(e.valid)[-1])

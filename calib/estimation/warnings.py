"""What speaks against an estimate although it is valid: the likely sensor or part, by name."""

import math

import numpy as np

from calib.base.intervals import Z95
from calib.base.warning import PlausibilityWarning, judged
from calib.car.bias import front_share
from calib.estimation.estimator import Estimate
from calib.logs.log import Log
from calib.plausibility.pads import of_changes
from calib.plausibility.run import run_warnings


def warnings_of(log: Log, e: Estimate) -> tuple[PlausibilityWarning, ...]:
    """Warnings on one log, from what its whole run says."""
    of_run = run_warnings(log, e.read, e.plan.nominal, e.accelerometer, e.response)
    if not e.valid.any():
        return of_run
    last = int(np.flatnonzero(e.valid)[-1])
    return (*of_run, *judged(log.name, of_changes(_together(e, last), _apart(e, last))))


def _apart(e: Estimate, i: int) -> tuple[float, float]:
    """ln of the front pads' change over the rear ones', at a sample; its sigma."""
    middle, low, high = e.best.step.change[:, i].tolist()
    return middle, (high - low) / (2.0 * Z95)


def _together(e: Estimate, i: int) -> tuple[float, float]:
    """ln of the brake force over that of the ramp's pads, at a sample; its sigma.

    The mass is not counted in the sigma, since another load is what it would tell.
    """
    plan, best = e.plan, e.best
    share = front_share(plan.table.vehicle, plan.table.calibration.pad_log_ratio.value)
    level = share * best.change_f.value[i] + (1.0 - share) * best.change_r.value[i]
    resistance = float(plan.known.sigma_z(plan.nominal, e.speed[i : i + 1])[0])
    sensors = float(best.step.noise[i] + best.step.accelerometer[i])
    ramp = sum(variance for part, variance in plan.ramp_level.items() if part != "mass")
    variance = sensors + (resistance / max(float(e.z[i]), 0.02)) ** 2 + ramp
    return math.log(level), math.sqrt(variance)

"""What speaks against an estimate although it is valid: the likely sensor or part, by name."""

import math
from collections.abc import Iterator

import numpy as np

from calib.base.intervals import Z95
from calib.base.warning import PlausibilityWarning
from calib.car.forces import axle_loads
from calib.estimation.estimator import Estimate
from calib.estimation.limits import Judgement
from calib.estimation.metrics import METRICS
from calib.logs.log import Log
from calib.plausibility.limits import PLAUSIBLE
from calib.plausibility.load import is_load, load_behind
from calib.plausibility.pads import change_warnings, level_warnings
from calib.plausibility.run import run_warnings
from calib.table.budget import front_share


def warnings_of(log: Log, e: Estimate) -> tuple[PlausibilityWarning, ...]:
    """Warnings on one log, from what its whole run says."""
    plan = e.plan
    of_run = run_warnings(log, e.read, plan.nominal, e.accelerometer, e.response)
    return (*of_run, *_pads(log.name, e))


def limit_warnings(log: str, judged: tuple[Judgement, ...]) -> Iterator[PlausibilityWarning]:
    """A warning for each metric that passes and lies outside the range without warning."""
    for one in judged:
        if one.warned and one.value is not None:
            yield PlausibilityWarning(
                one.figure,
                log,
                one.value,
                (one.warn_low, one.warn_high),
                (f"a stop, a sensor or pads that are not as usual: {METRICS[one.figure]}",),
                "look at this stop with `brake-cal check` and `brake-cal plot`",
            )


def _pads(log: str, e: Estimate) -> Iterator[PlausibilityWarning]:
    """How the pads changed against each other and together, at the last valid sample."""
    if not e.valid.any():
        return
    apart = pads_apart(e)
    level = pads_together(e)
    load = like_a_load(e, level[0], apart)
    changed = tuple(change_warnings(log, *apart, like_a_load=load))
    yield from changed
    if load or not changed:
        yield from level_warnings(log, *level)


def like_a_load(e: Estimate, level: float, apart: tuple[float, float]) -> bool:
    """Whether a load would make the pads seem changed as they do, within what is known of them.

    ``level``, ``apart`` as `pads_together` and `pads_apart` have them.
    """
    if not PLAUSIBLE.pad_level < abs(level) < PLAUSIBLE.loaded:
        return False
    car, z = e.plan.nominal, float(e.blocks.z[_block(e)])
    front, rear = axle_loads(car, np.asarray(z))
    share = front_share(car, e.plan.table.calibration.pad_log_ratio.value)
    transfer = z * car.cg_height / car.wheelbase
    ends = (apart[0] + sign * Z95 * apart[1] for sign in (-1.0, 1.0))
    where = (share, float(front / (front + rear)), transfer)
    return is_load(*(load_behind(level, end, *where) for end in ends))


def pads_apart(e: Estimate) -> tuple[float, float]:
    """ln of the front pads' change over the rear ones', at the last telling sample; its sigma."""
    of, last = e.best.change, _last(e)
    return float(of.value[last]), float((of.upper - of.lower)[last]) / (2.0 * Z95)


def pads_together(e: Estimate) -> tuple[float, float]:
    """ln of the brake force over that of the ramp's pads, at the last telling sample; its sigma.

    The mass is not counted in the sigma, since another load is what it would tell.
    """
    last, plan = _last(e), e.plan
    share = front_share(plan.table.vehicle, plan.table.calibration.pad_log_ratio.value)
    level = share * e.best.change_f.value[last] + (1.0 - share) * e.best.change_r.value[last]
    z = max(float(e.z[last]), 0.02)
    resistance = float(plan.known.sigma_z(plan.nominal, e.speed[last : last + 1])[0]) / z
    sensors = float(e.best.noise[last] + e.best.accelerometer[last])
    ramp = sum(variance for part, variance in plan.ramp_level.items() if part != "mass")
    return math.log(level), math.sqrt(sensors + resistance**2 + ramp)


def _last(e: Estimate) -> int:
    """The last telling sample."""
    return int(np.flatnonzero(e.telling)[-1])


def _block(e: Estimate) -> int:
    """The block of the last telling sample."""
    return min(int(np.searchsorted(e.blocks.end, e.time[_last(e)])), e.blocks.end.size - 1)

"""What speaks against an estimate although it is valid: the likely sensor or part, by name."""

import math
from collections.abc import Iterator

import numpy as np

from calib.estimation.estimator import Basis, Estimate
from calib.estimation.pads import level_change_sigma
from calib.logs.log import Log
from calib.plausibility.pads import change_warnings, level_warnings
from calib.plausibility.run import run_warnings
from calib.table.pads_budget import front_share
from calib.validation.limits import Judgement
from calib.validation.metrics import METRICS
from calib.warning import PlausibilityWarning


def warnings_of(log: Log, e: Estimate) -> tuple[PlausibilityWarning, ...]:
    """Warnings on one log, from what its whole run says."""
    plan = e.plan
    of_run = run_warnings(log, e.read, plan.nominal, plan.known.effects, e.accelerometer)
    return (*of_run, *_pads(log.name, e))


def limit_warnings(log: str, judged: tuple[Judgement, ...]) -> Iterator[PlausibilityWarning]:
    """A warning for each metric that passes and lies outside the range without warning."""
    for one in judged:
        if one.warned and one.value is not None:
            low = -math.inf if one.warn_low is None else one.warn_low
            high = math.inf if one.warn_high is None else one.warn_high
            yield PlausibilityWarning(
                one.figure,
                log,
                one.value,
                (low, high),
                (f"a stop, a sensor or pads that are not as usual: {METRICS[one.figure]}",),
                "look at this stop with `brake-cal check` and `brake-cal plot`",
            )


def _pads(log: str, e: Estimate) -> Iterator[PlausibilityWarning]:
    """How the pads changed against each other, else together, at the last valid sample."""
    if not e.valid.any():
        return
    apart = tuple(change_warnings(log, *pads_apart(e)))
    yield from apart
    if not apart and e.basis is not None:
        yield from level_warnings(log, *pads_together(e, e.basis))


def pads_apart(e: Estimate) -> tuple[float, float]:
    """ln of the front pads' change over the rear ones', at the last valid sample, and its sigma."""
    last = int(np.flatnonzero(e.valid)[-1])
    return math.log(float(e.front.change[last] / e.rear.change[last])), _sigma(e, last)


def pads_together(e: Estimate, basis: Basis) -> tuple[float, float]:
    """ln of the brake force over that of the ramp's pads, at the last valid sample, and its sigma.

    The sigma is that of pads that are not the ramp's: they are known as well as the mass.
    """
    last = int(np.flatnonzero(e.valid)[-1])
    share = front_share(e.plan.table.vehicle, e.plan.table.calibration.pad_log_ratio.value)
    front, rear = float(e.front.change[last]), float(e.rear.change[last])
    sigma = level_change_sigma(e.plan, basis.level.sigma)[last]
    return math.log(share * front + (1.0 - share) * rear), float(sigma)


def _sigma(e: Estimate, at: int) -> float:
    """Standard deviation of ln of the pads' ratio over that of the ramp, at a sample."""
    block = min(int(np.searchsorted(e.blocks.end, e.time[at])), e.blocks.end.size - 1)
    return float(e.split.change_sigma[block])

"""What speaks against an estimate although it is valid: the likely sensor or part, by name."""

import math
from collections.abc import Iterator

import numpy as np

from calib.estimation.estimator import Estimate
from calib.logs.log import Log
from calib.plausibility.pads import change_warnings
from calib.plausibility.run import run_warnings
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
    """How the pads changed against each other, at the last valid sample."""
    if e.valid.any():
        yield from change_warnings(log, *pads_apart(e))


def pads_apart(e: Estimate) -> tuple[float, float]:
    """ln of the front pads' change over the rear ones', at the last valid sample, and its sigma."""
    last = int(np.flatnonzero(e.valid)[-1])
    return math.log(float(e.front.change[last] / e.rear.change[last])), _sigma(e, last)


def _sigma(e: Estimate, at: int) -> float:
    """Standard deviation of ln of the pads' ratio over that of the ramp, at a sample."""
    block = min(int(np.searchsorted(e.blocks.end, e.time[at])), e.blocks.end.size - 1)
    return float(e.split.change_sigma[block])

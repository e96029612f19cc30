"""The uncertainty budget of an estimate: the variance of each pad friction, split by its cause.

    ln mu = ln level + lever ratio        lever: share of the other axle in the brake force

Of the level: mass (and resistance), accelerometer, noise. Of the ratio: what is read of eta, what
the ramp left open of tyres and pads, and the rest, which a stop may bring.
"""

import math
from collections.abc import Mapping

import numpy as np

from calib.car.bias import front_share
from calib.estimation.estimator import Estimate
from calib.estimation.readout import Bounded
from calib.table.budget import AxleBudget


def budget(e: Estimate) -> tuple[AxleBudget, AxleBudget] | None:
    """Budgets of the front and the rear pads; None without a valid sample.

    Of each axle the valid sample whose interval is the median one. The parts add up to the variance
    of its interval, half of its width.
    """
    if not e.valid.any():
        return None
    return _of_axle(e, e.best.pads_f, front=True), _of_axle(e, e.best.pads_r, front=False)


def _of_axle(e: Estimate, pads: Bounded, *, front: bool) -> AxleBudget:
    step, draws, car = e.best.step, e.table.draws, e.table.vehicle
    valid = np.flatnonzero(e.valid)
    order = np.argsort((pads.upper / pads.lower)[valid], kind="stable")
    i = valid[order[(order.size - 1) // 2]]  # the earlier one of an even number
    filed = car.front.pad_friction / car.rear.pad_friction
    share = front_share(car, math.log(e.best.ratio.value[i] / filed))
    lever = 1.0 - share if front else share
    whole, level = (float(x.sigma[i]) ** 2 for x in (pads, e.best.level))
    ramp = 0.0 if draws is None else float(np.var(draws.log_pad_ratio))
    of_level = {
        "accelerometer": float(step.accelerometer[i]),
        "noise": float(step.noise[i]),
    }
    of_ratio = {"zeros": lever**2 * float(step.zeros[i]), "tyres": lever**2 * ramp}
    parts = _split(level, of_level, "mass") | _split(whole - level, of_ratio, "unlike_pads")
    return AxleBudget(float(pads.value[i]), parts)


def _split(whole: float, known: Mapping[str, float], rest: str) -> dict[str, float]:
    """A variance by its parts: what is ``known``, as far as it goes, and the ``rest``."""
    parts = {}
    for part, variance in (*known.items(), (rest, math.inf)):
        parts[part] = min(variance, max(whole, 0.0))
        whole -= parts[part]
    return {part: variance for part, variance in parts.items() if variance > 0.0}

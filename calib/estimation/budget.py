"""The uncertainty budget of an estimate: the variance of each pad friction, split by its cause.

    ln mu = ln level + lever ratio        lever: share of the other axle in the brake force

Of the level: mass (and resistance), accelerometer, noise. Of the ratio: what is read of eta, what
the ramp left open of tyres and pads, and the rest, which a stop may bring.
"""

import math

import numpy as np

from calib.base.arrays import Mask
from calib.car.bias import front_share
from calib.estimation.estimator import Estimate
from calib.estimation.readout import Bounded
from calib.table.budget import AxleBudget


def budget(estimate: Estimate) -> tuple[AxleBudget, AxleBudget] | None:
    """Budgets of the front and the rear pads; None where no sample tells of them.

    Of each axle the sample whose interval is the median one of those that tell, see
    `Estimate.telling`. The parts add up to the variance of its interval, half of its width.
    """
    e = estimate
    if not e.telling.any():
        return None
    front, rear = (_median(e.telling, pads) for pads in (e.best.pads_f, e.best.pads_r))
    return _at(e, front, front_axle=True), _at(e, rear, front_axle=False)


def _median(telling: Mask, pads: Bounded) -> int:
    """Place of the sample with the median interval; the earlier one of an even number."""
    places = np.flatnonzero(telling)
    order = np.argsort((pads.upper / pads.lower)[places], kind="stable")
    return int(places[order[(order.size - 1) // 2]])


def _at(e: Estimate, i: int, *, front_axle: bool) -> AxleBudget:
    """Budget of one axle at one sample."""
    best, draws = e.best, e.table.draws
    pads = best.pads_f if front_axle else best.pads_r
    car = e.table.vehicle
    filed = car.front.pad_friction / car.rear.pad_friction
    share = front_share(car, math.log(best.ratio.value[i] / filed))
    lever = 1.0 - share if front_axle else share
    whole, level = (float(x.sigma[i]) ** 2 for x in (pads, best.level))
    ratio = max(whole - level, 0.0)
    sensors = min(float(best.step.noise[i] + best.step.accelerometer[i]), level)
    zeros = min(lever**2 * float(best.step.zeros[i]), ratio)
    ramp = 0.0 if draws is None else lever**2 * float(np.var(draws.log_pad_ratio))
    tyres = min(ramp, ratio - zeros)
    parts = {
        "mass": level - sensors,
        "accelerometer": min(float(best.step.accelerometer[i]), sensors),
        "noise": max(sensors - float(best.step.accelerometer[i]), 0.0),
        "zeros": zeros,
        "tyres": tyres,
        "unlike_pads": ratio - zeros - tyres,
    }
    found = {part: variance for part, variance in parts.items() if variance > 0.0}
    return AxleBudget(float(pads.value[i]), found)

"""The uncertainty budget of an estimate: the variance of each pad friction, split by its cause.

    ln mu = ln level + lever ratio        lever: share of the other axle in the brake force

Of the level: mass (and resistance), accelerometer, noise. Of the ratio: what is read of eta, what
the ramp left open of tyres and pads, and the rest, which a stop may bring.
"""

import numpy as np

from calib.car.balance import front_share
from calib.estimation.estimator import Estimate
from calib.estimation.readout import Bounded
from calib.table.budget import Parts, deviations


def budget(e: Estimate) -> tuple[Parts, Parts] | None:
    """Budgets of the front and the rear pads; None without a valid sample.

    Of each axle the valid sample whose interval is the median one. The parts add up to the variance
    of its interval, half of its width.
    """
    if not e.valid.any():
        return None
    return _of_axle(e, e.best.pads_f, 0), _of_axle(e, e.best.pads_r, 1)


def _of_axle(e: Estimate, pads: Bounded, axle: int) -> Parts:
    step, draws = e.best.step, e.table.draws
    order = np.argsort(np.where(e.valid, pads.upper / pads.lower, np.inf), kind="stable")
    i = order[(np.count_nonzero(e.valid) - 1) // 2]  # the earlier one of an even number
    share = front_share(e.table.vehicle, float(step.ratio[0, i]))
    lever = (1.0 - share, share)[axle] ** 2
    ramp = lever * np.var(draws.log_pad_ratio)
    whole, level = (x.sigma[i] ** 2 for x in (pads, e.best.level))
    of_level = ("accelerometer", step.accelerometer[i]), ("noise", step.noise[i]), ("mass", np.inf)
    of_ratio = ("zeros", lever * step.zeros[i]), ("tyres", ramp), ("unlike_pads", np.inf)
    parts = {}
    for variance, causes in ((level, of_level), (whole - level, of_ratio)):
        left = max(float(variance), 0.0)
        for part, known in causes:  # as far as it goes; the last one is the rest
            parts[part] = min(float(known), left)
            left -= parts[part]
    return deviations(parts)

"""The uncertainty budget of an estimate: the variance of each pad friction, split by its cause.

    ln mu = ln level + lever ratio             independent, as the interval has them
    variance = absolute^2 + (lever sigma)^2    `calib.estimation.pads`
               + motor + load + late           `calib.estimation.motor`, `.load`, `.delay`

``lever`` is the share of the other axle in the brake force. Level and ratio are each weighed
between "as on the ramp" and "free" (`calib.base.mixtures`). With the weight w of the
first, what was measured counts by w kept^2 + 1 - w, where kept is the share of a departure that the
first leaves; what is open of the ramp counts by w for the level. What the weighing itself leaves
open, and how exactly pads keep their friction, is the part "unlike_pads".

It is computed for one sample of each axle and only when asked for: the filter runs again and says
what each block did.
"""

from collections.abc import Sequence

import numpy as np
from numpy.typing import NDArray

from calib.car.balance import brake_forces
from calib.estimation.estimator import Basis, Estimate, split_of
from calib.estimation.pad_ratio import RatioStep
from calib.estimation.plan import Plan
from calib.estimation.split_budget import ratio_parts
from calib.estimation.weighed_level import WeighedLevel
from calib.table.budget import PARTS, AxleBudget, Parts, axle_budget

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]
Steps = Sequence[RatioStep | None]


def budget(estimate: Estimate) -> tuple[AxleBudget, AxleBudget] | None:
    """Budgets of the front and the rear pads; None where no sample tells of them.

    Of each axle the sample whose interval is the median one of those that tell, see
    `Estimate.telling`. Where there are valid ones it stands for the stop, and its sum is the
    interval that `calib.estimation.metrics` gives. The sum of the parts is the variance of that
    interval to rounding (1e-9 relative).
    """
    e, telling = estimate, estimate.telling
    if e.basis is None or not telling.any():
        return None
    steps: list[RatioStep | None] = []
    split_of(e.plan, e.blocks, e.basis.demand, steps)
    front, rear = (_median(telling, axle.lower, axle.upper) for axle in (e.front, e.rear))
    return (
        _at(e, e.basis, steps, front, e.front.pad_friction, front_axle=True),
        _at(e, e.basis, steps, rear, e.rear.pad_friction, front_axle=False),
    )


def _median(telling: Mask, lower: Array, upper: Array) -> int:
    """Place of the sample with the median interval; the earlier one of an even number."""
    places = np.flatnonzero(telling)
    order = np.argsort((upper / lower)[places], kind="stable")
    return int(places[order[(order.size - 1) // 2]])


def _at(
    e: Estimate, basis: Basis, steps: Steps, i: int, mu: Array, *, front_axle: bool
) -> AxleBudget:
    """Budget of one axle at one sample."""
    block = int(e.blocks.last_complete(e.time[i : i + 1])[0])
    p_f, p_r = (np.maximum(p[i], 1.0) for p in (e.pressure_f, e.pressure_r))
    front, rear = brake_forces(e.plan.nominal, p_f, p_r, e.split.log_pad_ratio[block])
    lever = float((rear if front_axle else front) / (front + rear))
    level, ratio = _level(e.plan, basis.level, i), _ratio(e, steps, block)
    motor, load, late = (
        0.0 if added is None else float(added[0 if front_axle else 1][i])
        for added in (e.motor, e.load, e.late)
    )
    further = {"motor": motor, "mass": load, "delay": late}
    return axle_budget(float(mu[i]), (1.0, level), (lever**2, ratio), (1.0, further))


def _level(plan: Plan, level: WeighedLevel, i: int) -> Parts:
    """Variance of the logarithm of the level at a sample, by part."""
    p, car = plan.priors, plan.nominal
    measured = {
        "mass": car.mass_tolerance**2,
        "resistance": float(level.resistance[i]) ** 2,
        "accelerometer": float(level.accelerometer[i]) ** 2,
        "noise": float(level.noise[i]) ** 2,
    }
    weight, free = float(level.nominal_weight[i]), float(level.free[i])
    counted, alike, apart = _weighed(weight, sum(measured.values()), free, p.level_alike)
    out = {part: counted * variance for part, variance in measured.items()}
    out["unlike_pads"] = alike + apart
    for part, variance in plan.ramp_level.items():
        out[part] = out.get(part, 0.0) + weight * variance
    return out


def _ratio(e: Estimate, steps: Steps, block: int) -> Parts:
    """Variance of the logarithm of the pads' ratio after a block, by part."""
    p, weight = e.plan.priors, float(e.split.nominal_weight[block])
    parts = ratio_parts(e.plan, e.blocks, steps, block)
    # on a strange surface the ratio errs today, not on the ramp
    today = np.array([[1.0, 0.0], [0.0, 0.0]])
    strange = (p.foreign * float(e.split.log_stiffness[block])) ** 2
    parts["tyres"] = parts["tyres"] + strange * today
    departure = np.array([1.0, -1.0])
    total = sum(parts.values(), np.zeros((2, 2)))
    variance = float(departure @ total @ departure)
    along = float(total[0] @ departure) / variance
    kept = p.ratio_alike**2 / (variance + p.ratio_alike**2)
    moved = float(e.split.change[block]) / (weight * kept + 1.0 - weight)
    _, alike, apart = _weighed(weight, variance, moved, p.ratio_alike)
    # as on the ramp: a departure is given back but for the share that is kept
    given_back = today[0] - along * (1.0 - kept) * departure
    out = {
        part: weight * float(given_back @ C @ given_back) + (1.0 - weight) * float(C[0, 0])
        for part, C in parts.items()
    }
    out["unlike_pads"] += along**2 * (alike + apart)
    return {part: out.get(part, 0.0) for part in PARTS}


def _weighed(
    weight: float, variance: float, departure: float, alike: float
) -> tuple[float, float, float]:
    """What a mixture of "alike" and "free" makes of a measured departure from nominal.

    ``variance`` of the ``departure``; ``alike`` how exactly alike pads keep it. Returns the factor
    on the variance of what was measured, the part that alike pads may move, and the spread between
    the two hypotheses: together the variance of `calib.base.mixtures`.
    """
    kept = alike**2 / (variance + alike**2)
    counted = weight * kept**2 + 1.0 - weight
    moves = weight * ((1.0 - kept) * alike) ** 2
    return counted, moves, weight * (1.0 - weight) * ((1.0 - kept) * departure) ** 2

"""Jolts of a_x: the body over a bump, which the brakes have no part in.

    demanded/nominal brake force over the last block    against its median over the last blocks

A force that stays changed becomes the median after half of these blocks, and is no jolt. The
accelerometer is judged with them: over a bump v follows what a_x feels.
"""

import numpy as np
from numpy.typing import NDArray

from calib.estimation.block_level import level_error
from calib.estimation.plan import Plan
from calib.run.axle_signals import Signals
from calib.run.blocks import Blocks
from calib.run.brake_response import brake_balance
from calib.run.filters import block_mean, trailing_mean

Array = NDArray[np.float64]


def without_jolts(plan: Plan, s: Signals, b: Blocks) -> Array:
    """Deceleration [1] of a run that has the usual brake force in a jolt, (n,); causal.

    ``s``, ``b`` the run as read. No jolt is told in the first half second of a braking.
    """
    p, forces = plan.priors, brake_balance(plan.nominal, plan.known.effects, s)
    nominal = np.where(forces.active, forces.nominal_f + forces.nominal_r, 0.0)
    demanded = np.where(forces.active, forces.balance.demanded, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        level = block_mean(demanded, b.samples) / block_mean(nominal, b.samples)
        now = trailing_mean(demanded, b.samples) / trailing_mean(nominal, b.samples)
        last = b.last_complete(s.time)
        usual, z = (_usual(x, round(p.level_memory / b.length)) for x in (level, b.z))
        error = np.hypot(p.jolt_gate * level_error(b, z, plan.noise.z, p), p.jolt_least)
        jolted = forces.active & (np.abs(now / usual[last] - 1.0) > error[last])
    off = np.where(jolted, usual[last] * nominal - demanded, 0.0)
    return np.asarray(s.z + off / plan.nominal.weight)


def _usual(x: Array, count: int) -> Array:
    """Median of the last ``count`` values up to each, (k,); NaN where one of them is."""
    if x.size < count:
        return np.full(x.size, np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(x, count)
    return np.concatenate([np.full(count - 1, np.nan), np.median(windows, axis=1)])

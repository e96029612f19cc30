"""Samples in which the accelerometer shows a jolt: the body over a bump, not the brakes.

    demanded/nominal brake force over the last block    against its median over the last blocks

A force that stays changed becomes the median after half of these blocks, and is no jolt.
"""

import numpy as np
from numpy.typing import NDArray

from calib.estimation.block_level import level_error
from calib.estimation.priors import Priors
from calib.signals.blocks import Blocks
from calib.signals.brake_balance import BrakeBalance
from calib.signals.filters import block_mean, trailing_mean

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]


def jolted(time: Array, forces: BrakeBalance, b: Blocks, density: float, priors: Priors) -> Mask:
    """Samples with a jolt, causal, (n,).

    ``time`` [s] of the samples; ``b`` the same run in blocks; ``density`` of the noise of z
    [s^0.5]. None in the first blocks of a braking.
    """
    nominal = np.where(forces.active, forces.nominal_f + forces.nominal_r, 0.0)
    demanded = np.where(forces.active, forces.balance.demanded, 0.0)
    with np.errstate(divide="ignore", invalid="ignore"):
        level = block_mean(demanded, b.samples) / block_mean(nominal, b.samples)
        now = trailing_mean(demanded, b.samples) / trailing_mean(nominal, b.samples)
        usual = _before(level, round(priors.level_memory / b.length))
        error = np.hypot(priors.jolt_gate * level_error(b, density, priors), priors.jolt_least)
        last = b.last_complete(time)
        off = np.abs(now / usual[last] - 1.0)
        return np.asarray(off > error[last])


def _before(level: Array, count: int) -> Array:
    """Median of the last ``count`` values up to each, (k,); NaN where one of them is."""
    if level.size < count:
        return np.full(level.size, np.nan)
    windows = np.lib.stride_tricks.sliding_window_view(level, count)
    return np.concatenate([np.full(count - 1, np.nan), np.median(windows, axis=1)])

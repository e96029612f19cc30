"""Load that the pitch of the body has not moved yet, block by block, and how the mode moves it."""

import math
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calib.car.effects.body import pitch_deficit
from calib.car.vehicle import Vehicle
from calib.estimation.priors import Priors
from calib.run.blocks import Blocks

Array = NDArray[np.float64]

STEP = 0.05
"""Step of ln frequency for the slope [1]: small against a turn of the mode in the time that it
lasts."""


class _BlockPitch(NamedTuple):
    """``deficit`` in the middle of each block over the weight [1], (k,).

    ``slope`` of it by the logarithm of the mode's frequency [1], (k,).
    """

    deficit: Array
    slope: Array


def block_pitch(car: Vehicle, b: Blocks, priors: Priors) -> _BlockPitch:
    """Follow the mode of the priors from block to block (`pitch_coupling.pitch_deficit`)."""
    middle = b.length * np.arange(b.end.size, dtype=np.float64)
    slow, usual, fast = (
        pitch_deficit(car, middle, b.z, priors.pitch_frequency * math.exp(by), priors.pitch_damping)
        for by in (-STEP, 0.0, STEP)
    )
    return _BlockPitch(usual, (fast - slow) / (2.0 * STEP))

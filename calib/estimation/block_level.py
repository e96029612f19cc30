"""The pads' level that the split of a block rests on: by pressure, or by deceleration.

    level by pressure       `calib.estimation.pad_level`, of the last half second
    level by deceleration   demanded/nominal brake force of the block itself

The first one is smooth, but it takes pressure and force for simultaneous. Brakes that follow late
while the pressure moves put an error into it, which lasts as long as its memory. The second one has
all noise of the accelerometer. They are weighed by these two errors, relative to the level:

    late    delay_sigma |p'|/p, kept for level_memory
    noisy   density of z over sqrt(T) z
"""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from calib.estimation.priors import Priors
from calib.run.blocks import Blocks
from calib.run.filters import low_pass

Array = NDArray[np.float64]

_LEAST_Z = 0.01
"""Deceleration [1] below which its relative noise is that of this one: nothing brakes there."""

LEAST_PRESSURE = 3e5
"""Pressure [Pa] below which a change is counted as one of this pressure."""


class _BlockLevel(NamedTuple):
    """``value`` of the level of each block, and its relative ``error``, (k,) [1]."""

    value: Array
    error: Array


def block_level(
    by_pressure: Array, by_deceleration: Array, b: Blocks, density: float, priors: Priors
) -> _BlockLevel:
    """Weigh the two levels of each block, (k,) [1]; ``density`` of the noise of z [s^0.5]."""
    late, noisy = _late(b, priors), _noisy(b, b.z, density)
    share = late**2 / (late**2 + noisy**2)
    return _BlockLevel(
        by_pressure + share * (by_deceleration - by_pressure),
        np.hypot((1.0 - share) * late, share * noisy),
    )


def level_error(b: Blocks, z: Array, density: float, priors: Priors) -> Array:
    """Greatest relative error of the level by the force of each block alone, (k,) [1].

    At the deceleration ``z`` [1], (k,). What is late counts with all of the block's own change of
    pressure.
    """
    late = np.maximum(_late(b, priors), priors.delay_sigma * pressure_moves(b))
    return np.asarray(np.hypot(late, _noisy(b, z, density)))


def _late(b: Blocks, priors: Priors) -> Array:
    moves = low_pass(pressure_moves(b), b.length, priors.level_memory)
    return np.asarray(priors.delay_sigma * moves)


def _noisy(b: Blocks, z: Array, density: float) -> Array:
    return np.asarray(density / np.sqrt(b.length) / np.maximum(z, _LEAST_Z))


def pressure_moves(b: Blocks) -> Array:
    """Share of itself by which the pressure moves, (k,) [1/s]."""
    p = np.maximum(b.p_f, b.p_r)
    return np.asarray(np.abs(np.diff(p, prepend=p[0])) / b.length / np.maximum(p, LEAST_PRESSURE))

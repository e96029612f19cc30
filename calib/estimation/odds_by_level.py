"""What the level of the pads says for or against a ratio that is that of the ramp.

    unchanged     the level of the ramp                       its ratio
    alike         any level                                   its ratio
    one axle      a level that its share of the force moves   any ratio
    both          any level                                   any ratio

A half of the pads that keep the ratio keep the level, too, and of the others half changed on both
axles. A level that is that of the ramp then speaks for a ratio that is, one that is a little off
for pads of one axle, and one that is far off for neither.
"""

import numpy as np
from numpy.typing import NDArray

from calib.estimation.priors import Priors

Array = NDArray[np.float64]


def odds_by_level(level: Array, sigma: Array, front_share: float, priors: Priors) -> Array:
    """Factor (k,) on the odds that the pads have the ratio of the ramp; 1 where no level is known.

    It is the density of the level that was measured with such pads over that with others.

    ``level`` logarithm over that of the ramp [1] (k,), NaN where not known, with its error
    ``sigma``; ``front_share`` of the brake force [1].
    """
    p = priors
    unchanged = _density(level, np.hypot(sigma, p.level_alike))
    alike = both = _density(level, np.hypot(sigma, p.level_free))
    front, rear = (
        _density(level, np.hypot(sigma, share * p.ratio))
        for share in (front_share, 1.0 - front_share)
    )
    kept = 0.5 * (unchanged + alike)
    changed = 0.25 * (front + rear) + 0.5 * both
    return np.where(np.isfinite(level), kept / changed, 1.0)


def _density(x: Array, sigma: Array) -> Array:
    """Density of a normal distribution around zero, less a constant factor."""
    return np.asarray(np.exp(-0.5 * (x / sigma) ** 2) / sigma)

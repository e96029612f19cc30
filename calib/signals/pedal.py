"""The driver's pressure without sensor noise.

Effects with memory, such as hysteresis, would react to the noise; and the noise of a sensor that
does not read below zero has a positive mean, like a slight constant braking.
"""

import math

import numpy as np
from numpy.typing import NDArray

from calib.signals.filters import centred_mean, third_difference, typical_differences
from calib.statistics.intervals import NINETY, QUARTILE

Array = NDArray[np.float64]

HOLD = 0.1
"""Width [s] over which a constant pressure is averaged."""

NOTHING = 0.4e5
"""A constant pressure below this [Pa] is zero: return springs keep the pads off the disc."""


def as_pressed(p: Array, step: float) -> Array:
    """Pressure [Pa] (n,) averaged where it is constant, smoothed where it changes; ``step`` [s].

    Constant means within eight sigma over twice the width. Elsewhere a sample is replaced by a
    parabola through its neighbours, unless that differs by more than four sigma: a fast application
    stays sharp. A pressure without noise is not changed.
    """
    from scipy.ndimage import maximum_filter1d, minimum_filter1d
    from scipy.signal import savgol_filter

    width = max(1, round(HOLD / step))
    if width < 3 or p.size < 2 * width:
        return p
    sigma = noise_of(p)
    mean = centred_mean(p, width, held_ends=True)
    swing = maximum_filter1d(p, 2 * width) - minimum_filter1d(p, 2 * width)
    held = swing < 8.0 * sigma
    bent = savgol_filter(p, max(5, width | 1), 2)
    moving = np.where(np.abs(bent - p) < 4.0 * sigma, bent, p)
    return np.where(held, np.where(mean < NOTHING, 0.0, mean), moving)


def noise_of(p: Array) -> float:
    """Standard deviation of the white noise of a pressure (n,), from its third differences.

    From the median of their sizes; where that is zero, as for a noise that seldom reaches the next
    step of the reading, from what a tenth of them exceeds. A pressure that is sent seldom, and runs
    in straight lines, shows its noise over more samples alone: these count where they show
    `HIDDEN` times as much.
    """
    fine = _typical(third_difference(p, 1))
    most = max(typical_differences(p, WIDEST)[1:], default=0.0)
    return (most if most > HIDDEN * fine else fine) / math.sqrt(20.0)


WIDEST = 8
"""Most samples between those of the further third differences."""

HIDDEN = 1.5
"""Noise over more samples, over that from sample to sample, that no white noise has."""


def _typical(x: Array) -> float:
    """The standard deviation of noise with few outliers."""
    median, high = np.quantile(np.abs(x), (0.5, 0.9))
    return float(median / QUARTILE if median > 0.0 else high / NINETY)

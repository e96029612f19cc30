"""The driver's pressure without the noise of its sensor, for a simulation.

Effects with memory, such as hysteresis, would react to the noise, and noise that is cut at zero has
a positive mean, like slight braking.
"""

import math

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.intervals import Z90, noise_over
from calib.run.filters import centred_mean, samples_in

_HOLD = 0.1  # width over which a constant pressure is averaged [s]
_WIDEST = 8  # largest lag of a third difference [samples]
_INTERPOLATED = 1.5
"""A pressure is interpolated if its noise at larger lags is this many times that at lag one [1]."""
RELEASED = 0.4e5  # a constant pressure below this [Pa] counts as zero: springs keep the pads off
_NOISE = 4.0  # largest deviation by noise [sigma]
_CONSTANT = 2.0 * _NOISE  # range of a constant pressure within 2 `_HOLD` [sigma]
_PEAK = 2.0 * _NOISE
"""Height up to which a peak beside a constant pressure is noise [sigma]: where pressure begins to
change, both the parabola and the sample may err by `_NOISE`."""


def as_pressed(p: Array, step: float) -> Array:
    """Pressure [Pa] (n,) averaged where it is constant, smoothed where it changes; ``step`` [s]."""
    from scipy.ndimage import maximum_filter1d, minimum_filter1d
    from scipy.signal import savgol_filter

    width = samples_in(_HOLD, step)
    if width < 3 or p.size < 2 * width:
        return p
    sigma = _noise_of(p)
    mean = centred_mean(p, width, held_ends=True)
    swing = maximum_filter1d(p, 2 * width) - minimum_filter1d(p, 2 * width)
    constant = swing < _CONSTANT * sigma
    parabola = savgol_filter(p, max(5, width | 1), 2)
    # a sample far from the parabola stays, so that a fast application stays sharp
    changing = np.where(np.abs(parabola - p) < _NOISE * sigma, parabola, p)
    smooth = np.where(constant, np.where(mean < RELEASED, 0.0, mean), changing)
    return _without_peaks(smooth, constant, _PEAK * sigma, width)


def _without_peaks(p: Array, constant: Mask, limit: float, width: int) -> Array:
    """Pressure [Pa] (n,) without peaks of noise beyond the ``constant`` pressures around them.

    Hysteresis would keep such a peak. A peak higher than ``limit`` [Pa], or of ``width`` samples
    or more, is made by the driver and stays.
    """
    from scipy.ndimage import binary_opening

    index = np.arange(p.size)
    previous = np.maximum.accumulate(np.where(constant, index, -1))
    following = np.minimum.accumulate(np.where(constant, index, p.size)[::-1])[::-1]
    levels = np.append(p, np.nan)  # indices -1 and n: no constant pressure on that side
    earlier, later = levels[previous], levels[following]
    excess = p - np.clip(p, np.fmin(earlier, later), np.fmax(earlier, later))
    is_peak = excess != 0.0
    is_long = binary_opening(is_peak, np.ones(width))
    return np.where(is_peak & (np.abs(excess) < limit) & ~is_long, p - excess, p)


def _noise_of(p: Array) -> float:
    """Standard deviation of the noise of a pressure (n,), from its third differences."""
    at_lag_one, *at_larger_lags = noise_over(p, _WIDEST)
    if at_lag_one == 0.0:  # noise below the resolution, whose median is 0: take the 90 % quantile
        at_lag_one = float(np.quantile(np.abs(np.diff(p, 3)), 0.9)) / Z90 / math.sqrt(20.0)
    # an interpolated pressure has its noise in differences over several samples
    largest = max(at_larger_lags, default=0.0)
    return largest if largest > _INTERPOLATED * at_lag_one else at_lag_one

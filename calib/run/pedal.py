"""The driver's pressure without sensor noise.

Effects with memory, such as hysteresis, would react to the noise. Noise that is cut at zero has a
positive mean, like slight braking.
"""

import math

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.intervals import NINETY, noise_over
from calib.run.filters import centred_mean, samples_in

_HOLD = 0.1  # width over which a constant pressure is averaged [s]
_WIDEST = 8  # largest lag of a third difference [samples]
_HIDDEN = 1.5  # noise at a larger lag over that at lag one, from which it is not white

NOTHING = 0.4e5  # a constant pressure below this [Pa] is zero: springs keep the pads off

_PEAK = 8.0
"""Height of a peak beside a constant pressure, in sigma of the noise, up to which it is noise: a
parabola over a corner errs by four sigma, and the sample there by as many."""


def as_pressed(p: Array, step: float) -> Array:
    """Pressure [Pa] (n,) averaged where it is constant, smoothed where it changes; ``step`` [s].

    Constant means within eight sigma over twice the width. Elsewhere a parabola through its
    neighbours replaces a sample, unless they differ by more than four sigma: a fast application
    stays sharp. A pressure without noise is not changed.
    """
    from scipy.ndimage import maximum_filter1d, minimum_filter1d
    from scipy.signal import savgol_filter

    width = samples_in(_HOLD, step)
    if width < 3 or p.size < 2 * width:
        return p
    sigma = _noise_of(p)
    mean = centred_mean(p, width, held_ends=True)
    swing = maximum_filter1d(p, 2 * width) - minimum_filter1d(p, 2 * width)
    constant = swing < 8.0 * sigma
    parabola = savgol_filter(p, max(5, width | 1), 2)
    moving = np.where(np.abs(parabola - p) < 4.0 * sigma, parabola, p)
    smooth = np.where(constant, np.where(mean < NOTHING, 0.0, mean), moving)
    return _without_peaks(smooth, constant, _PEAK * sigma, width)


def _without_peaks(p: Array, constant: Mask, most: float, width: int) -> Array:
    """Pressure [Pa] (n,) without peaks of noise beyond the ``constant`` pressures around them.

    Hysteresis would keep such a peak. Peaks of more than ``most`` [Pa], or of ``width`` samples or
    more, are of the foot and stay.
    """
    from scipy.ndimage import binary_opening

    place = np.arange(p.size)
    previous = np.maximum.accumulate(np.where(constant, place, -1))
    following = np.minimum.accumulate(np.where(constant, place, p.size)[::-1])[::-1]
    levels = np.append(p, np.nan)  # -1 and n: no constant pressure on that side
    ends = levels[previous], levels[following]
    past = p - np.clip(p, np.fmin(*ends), np.fmax(*ends))
    short = (past != 0.0) & (np.abs(past) < most)
    return np.where(short & ~binary_opening(past != 0.0, np.ones(width)), p - past, p)


def _noise_of(p: Array) -> float:
    """Standard deviation of the white noise of a pressure (n,), from its third differences.

    From their median; if that is zero, as for noise below the resolution, from their 90 % quantile.
    An interpolated pressure shows its noise at larger lags, which count if they show `_HIDDEN`
    times as much.
    """
    fine, *over = noise_over(p, _WIDEST)
    if fine == 0.0:
        fine = float(np.quantile(np.abs(np.diff(p, 3)), 0.9)) / NINETY / math.sqrt(20.0)
    most = max(over, default=0.0)
    return most if most > _HIDDEN * fine else fine

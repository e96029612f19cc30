"""What the foot did: a pressure without the noise of its sensor.

Whatever has memory, such as hysteresis, would take the noise for the foot; and a sensor that does
not read below nought reads its noise as a slight, lasting brake.
"""

import numpy as np
from numpy.typing import NDArray

from calib.signals.filters import centred_mean
from calib.statistics.intervals import QUARTILE

Array = NDArray[np.float64]

HOLD = 0.1
"""Width [s] over which a held pressure is averaged."""

NOTHING = 0.4e5
"""A held pressure below this [Pa] is no pressure: return springs hold the pads off."""


def as_pressed(p: Array, step: float) -> Array:
    """Pressure [Pa] (n,) averaged where it is held, smoothed where it moves; ``step`` [s].

    Held is what stays within eight sigma over twice the width. Elsewhere a parabola through the
    samples around stands for each, unless it lies more than four sigma off: a bite stays sharp.
    Sigma is that of the third differences. A pressure without noise comes back as it is.
    """
    from scipy.ndimage import maximum_filter1d, minimum_filter1d
    from scipy.signal import savgol_filter

    width = max(1, round(HOLD / step))
    if width < 3 or p.size < 2 * width:
        return p
    sigma = float(np.median(np.abs(np.diff(p, 3)))) / QUARTILE / np.sqrt(20.0)
    mean = centred_mean(p, width, held_ends=True)
    swing = maximum_filter1d(p, 2 * width) - minimum_filter1d(p, 2 * width)
    held = swing < 8.0 * sigma
    bent = savgol_filter(p, max(5, width | 1), 2)
    moving = np.where(np.abs(bent - p) < 4.0 * sigma, bent, p)
    return np.where(held, np.where(mean < NOTHING, 0.0, mean), moving)

"""The zeros of eta and slip age: rolling radii walk, and the last seconds before the bite count.

    r  noise density of what is zeroed [s^0.5]       a mean over T has sd r/sqrt(T)
    q  walk of the zero [1/s^0.5]                    over T it walks by q sqrt(T)
    tau = r/q                                        steady gain of the Kalman filter: 1/tau

That gain is that of weights exp(-age/tau), and their variance r^2/tau = r q is its own: half of it
is noise, half is what the zero walked meanwhile (Simon, Optimal State Estimation, section 7.1). A
lead-in much shorter than tau is averaged as if nothing walked.
"""

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
Mask = NDArray[np.bool_]

WALK = 1.2e-5
"""Walk q of the ratio of two rolling radii, and of radius to v [1/s^0.5]. A tyre that warms by 30 K
in five minutes rolls on a radius 0.1 % larger, 3e-6 a second. With usual wheel speeds, r 4e-5, tau
is 3 s: the zero then lags by 1e-5 and has noise of 2e-5. A walk that makes 0.1 % in five minutes
would forget a lead-in within half a second; a tyre that warms is steadier over seconds."""

OLDEST = 12.0
"""Age over tau past which all is forgotten: its weight is 6e-6."""


def aged(time: Array, rolling: Mask, density: Array) -> Array:
    """Factor (n,) by which what was measured while ``rolling`` (n,) has lost its sigma, 1 or more.

    ``time`` [s] (n,); ``density`` r [s^0.5] (n,). 1 at the end of the rolling and where the car
    does not roll; infinite where it is forgotten.
    """
    if not rolling.any():
        return np.ones_like(time)
    age = (time[rolling][-1] - time) * WALK / density
    factor = np.exp(0.5 * np.clip(age, 0.0, OLDEST))
    return np.where(rolling, np.where(age > OLDEST, np.inf, factor), 1.0)

"""Samples of an ECU whose sensors fail."""

import numpy as np

from calib.base.arrays import Array
from calib.ecu.channels import CHANNELS, OMEGA

NOTHING = (np.nan, np.inf, -np.inf, 1e30, 1e-40, 0.0)
READ = np.array([(channel.low, channel.high, *NOTHING) for channel in CHANNELS.values()])
"""What each channel may read once it fails (10, 8)."""


def failing(samples: Array, seed: int) -> Array:
    """Samples (n, 10) in pieces, each with gains and zeros that are wrong but go into the filter;
    some channels read an end of their range, or no number."""
    x, rng = samples.copy(), np.random.default_rng(seed)
    for part in np.split(x, np.sort(rng.integers(len(x), size=(5, 20, 100)[seed % 3]))):
        pressure, deceleration, wheels, front = np.exp(rng.normal(0.0, [1.0, 1.0, 0.5, 0.03]))
        part[:, :2] *= pressure, deceleration
        part[:, OMEGA] *= wheels * np.array([front, front, 1.0, 1.0])
        part[:, :6] += rng.normal(0.0, [1e5, 1.0, *(0.03,) * 4])
        fails = rng.random(len(CHANNELS)) < 0.02
        part[:, fails] = READ[fails, rng.integers(READ.shape[1])]
    return x

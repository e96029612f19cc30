"""Logs as another processor might have them: a thousandth of a sensor's resolution is different."""

from dataclasses import replace

import numpy as np

from calib.logs.log import Log

SIZE = 1e-8  # standard deviation of the changes, over the value [1]


def jittered(log: Log, seed: int, size: float = SIZE) -> Log:
    """The log with all channels but time times 1 + ``size`` normal noise."""
    rng = np.random.default_rng(seed)
    moved = {
        name: x if name == "time" else x * (1.0 + size * rng.standard_normal(x.size))
        for name, x in log.channels.items()
    }
    return replace(log, channels=moved)

"""Logs as another processor might have them: a thousandth of a sensor's resolution is different."""

from dataclasses import replace

import numpy as np

from calib.logs.log import Log
from tests.support.hidden.cases import HiddenCase

SIZE = 1e-8  # standard deviation of the changes, over the value [1]


def jittered(log: Log, seed: int, size: float = SIZE) -> Log:
    """The log with all channels but time times 1 + ``size`` normal noise."""
    rng = np.random.default_rng(seed)
    channels = {
        name: x if name == "time" else x * (1.0 + size * rng.standard_normal(x.size))
        for name, x in log.channels.items()
    }
    return replace(log, channels=channels)


def moved(case: HiddenCase, seed: int) -> HiddenCase:
    """The case in one of the ways in which rounding may have it."""
    parts = (
        tuple(jittered(log, seed + 10 * i) for i, log in enumerate(part))
        for part in (case.calibration, case.holdout)
    )
    calibration, holdout = parts
    return replace(case, calibration=calibration, holdout=holdout)

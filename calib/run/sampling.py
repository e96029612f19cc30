"""Sampling of a log: how many samples, at which rate, and which are missing."""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array
from calib.logs.clock import GAP, step_of


@dataclass(frozen=True)
class Sampling:
    """Clock of a log.

    ``duration`` [s]; ``rate`` of the mean step [Hz]; ``jitter`` root mean square deviation of
    the steps from it, without gaps [s]; ``gaps`` as (start [s], length [s]).
    """

    samples: int
    duration: float
    rate: float
    jitter: float
    gaps: tuple[tuple[float, float], ...]


def sampling_of(time: Array) -> Sampling:
    """Sampling of a strictly increasing time [s], shape (n,)."""
    steps, step = np.diff(time), step_of(time)
    wide = steps > GAP * step
    jitter = steps[~wide] - step
    return Sampling(
        samples=time.size,
        duration=float(time[-1] - time[0]),
        rate=1.0 / step,
        jitter=float(np.sqrt(np.mean(jitter**2))),
        gaps=tuple((float(time[i]), float(steps[i])) for i in np.flatnonzero(wide)),
    )

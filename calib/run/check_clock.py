"""The clock of a log: rate, jitter, gaps."""

from dataclasses import dataclass

import numpy as np
from numpy.typing import NDArray

from calib.logs.clock import GAP, step_of

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Clock:
    """Sampling of a log.

    ``duration`` [s]; ``rate`` of the mean step [Hz]; ``jitter`` root mean square deviation of
    the steps from it, without gaps [s]; ``gaps`` as (start [s], length [s]).
    """

    samples: int
    duration: float
    rate: float
    jitter: float
    gaps: tuple[tuple[float, float], ...]


def clock_of(time: Array) -> Clock:
    """Sampling of a strictly increasing time [s], shape (n,)."""
    steps = np.diff(time)
    step = step_of(time)
    wide = steps > GAP * step
    jitter = steps[~wide] - step
    return Clock(
        samples=time.size,
        duration=float(time[-1] - time[0]),
        rate=1.0 / step,
        jitter=float(np.sqrt(np.mean(jitter**2))),
        gaps=tuple((float(time[i]), float(steps[i])) for i in np.flatnonzero(wide)),
    )

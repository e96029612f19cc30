"""The clock of the solver: as fine as it needs, whatever the clock of the inputs is."""

from dataclasses import dataclass

import numpy as np

from calib.base.arrays import Array, Index

STEP = 0.005
"""Longest step of the solver [s]. The backward difference of the wheels' speed is half a step late,
and with it their momentum: with rotating masses of 4 %, a change of 5 m/s^2 puts v off by
0.0005 m/s. At 0.025 s it is 0.0024 m/s, and a noise-free log shows that
(tests/model/test_clock.py)."""


@dataclass(frozen=True)
class FineClock:
    """``time`` [s] (m,) with every sample of the inputs' clock, at the places ``at`` (n,)."""

    time: Array
    at: Index

    def along(self, x: Array) -> Array:
        """Inputs ``x`` (n,) in straight lines between their samples (m,)."""
        if self.time.size == self.at.size:
            return x
        return np.interp(np.arange(self.time.size), self.at, x)

    def before(self, end: int) -> Index:
        """Places of the samples of the inputs' clock before the place ``end``."""
        return self.at[: np.searchsorted(self.at, end)]


def fine_clock(time: Array) -> FineClock:
    """Divide every step of ``time`` [s] (n,), increasing, into equal ones of `STEP` at most.

    >>> import numpy as np
    >>> fine_clock(np.array([0.0, 0.02, 0.021])).time.round(6).tolist()
    [0.0, 0.005, 0.01, 0.015, 0.02, 0.021]
    """
    parts = np.ceil(np.diff(time) / STEP - 1e-6).astype(np.intp)
    at = np.concatenate([[0], np.cumsum(np.maximum(parts, 1))]).astype(np.intp)
    return FineClock(np.interp(np.arange(at[-1] + 1), at, time), at)

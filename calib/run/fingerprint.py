"""The fingerprint of a run: its noise, small enough for the record of a table.

Two runs have noise of their own, also where a robot drives them alike. So the means of the channels
over 50 ms, written to a quarter of their noise, tell a copy of the run that was cut, thinned,
rounded or resampled from every other run (`calib.run.same_run`). Second differences of these
whole numbers are small: a run of 10 s takes about 5 kB.

    mean over 50 ms / unit -> whole numbers -> second differences -> "1874 -2 0 3 -1 ..."
"""

import math
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

from calib.base.names import WHEELS
from calib.logs.log import Log
from calib.run.limits import LIMITS
from calib.run.run_view import COMPARED, View, noise_of, view_of, with_wheels

Array = NDArray[np.float64]

VERSION = 1

FINE = 0.25
"""Unit of the whole numbers over the noise [1]: rounding adds 0.3 % to the noise's square."""

MOST = 2.0**40
"""Largest whole number of a channel that has no noise."""


@dataclass(frozen=True)
class FingerprintChannel:
    """A channel: its whole numbers are of ``unit`` [SI].

    ``differences`` are their second differences as text; the two before the first count as 0.
    """

    name: str
    unit: float
    differences: str


@dataclass(frozen=True)
class Fingerprint:
    """Means of the channels of a run, one after another without a gap.

    ``version`` of this format; ``step`` length of a mean [s].
    """

    version: int
    step: float
    channels: tuple[FingerprintChannel, ...]

    def __post_init__(self) -> None:
        """Raise ValueError for a fingerprint that is not one of this format."""
        names = [channel.name for channel in self.channels]
        if self.version != VERSION:
            raise ValueError(f"fingerprint of version {self.version}, known is {VERSION}")
        if not {f"omega_{w}" for w in WHEELS} <= set(names) <= set(COMPARED):
            raise ValueError(f"a fingerprint has the channels of a run, not {', '.join(names)}")
        if not all(0.0 < x < math.inf for x in (self.step, *(c.unit for c in self.channels))):
            raise ValueError("the step and the units of a fingerprint are above 0")
        if len({_decoded(channel.differences).size for channel in self.channels}) != 1:
            raise ValueError("the channels of a fingerprint are of one length")

    @cached_property
    def view(self) -> View:
        """The means of the channels [SI], each (n,), and of the wheels."""
        return with_wheels({c.name: _decoded(c.differences) * c.unit for c in self.channels})


def fingerprint_of(log: Log) -> Fingerprint:
    """The fingerprint of a run, which must have its wheel speeds."""
    view = view_of(log, LIMITS.run_means, means=True)
    return Fingerprint(
        VERSION,
        LIMITS.run_means,
        tuple(_channel(name, view[name]) for name in COMPARED if name in view),
    )


def _channel(name: str, x: Array) -> FingerprintChannel:
    unit = _unit(x)
    whole = np.round(x / unit).astype(np.int64)
    return FingerprintChannel(name, unit, " ".join(map(str, np.diff(whole, 2, prepend=[0, 0]))))


def _unit(x: Array) -> float:
    """A power of two, so that no rounding enters a product with it."""
    least = max(FINE * noise_of(x), float(np.max(np.abs(x), initial=0.0)) / MOST)
    return 2.0 ** math.floor(math.log2(least)) if least > 0.0 else 1.0


def _decoded(text: str) -> Array:
    """Raises ValueError for text that is no list of whole numbers."""
    try:
        differences = np.array([int(word) for word in text.split()], dtype=np.int64)
    except OverflowError as error:
        raise ValueError("a number of a fingerprint is too large") from error
    return np.cumsum(np.cumsum(differences)).astype(float)

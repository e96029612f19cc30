"""One run as a value: canonical channels in SI, whatever file they came from."""

from dataclasses import dataclass, field
from functools import cached_property

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]


@dataclass(frozen=True)
class Origin:
    """Where a channel was taken from: SI value = factor * written + offset.

    ``source`` as the file names it, with the ``unit`` in which it was understood.
    """

    channel: str
    source: str
    unit: str
    factor: float
    offset: float


@dataclass(frozen=True)
class Log:
    """One run.

    Attributes
    ----------
    name : file stem.
    source : where it came from, for messages.
    digest : SHA-256 of the file's bytes; of the content for a log made by ``simulate``.
    channels : canonical channels [SI], each of shape (n,), ``time`` among them.
    truth : truth channels of a simulation [SI]; only scores may read them.
    ignored : source channels that were not taken.
    notes : what the reader did to the data, in words.
    origins : which source channel each was taken from, and how; empty for a log that was made.
    """

    name: str
    source: str
    digest: str
    channels: dict[str, Array]
    truth: dict[str, Array] = field(default_factory=dict)
    ignored: tuple[str, ...] = ()
    notes: tuple[str, ...] = ()
    origins: tuple[Origin, ...] = ()

    def __repr__(self) -> str:
        names = ", ".join(self.channels) + (" + truth" if self.truth else "")
        span = f", {self.time[0]:g} to {self.time[-1]:g} s" if self.time.size else ""
        return f"Log {self.name}: {self.time.size} samples{span}: {names}"

    def __getitem__(self, channel: str) -> Array:
        return self.channels[channel]

    def __contains__(self, channel: str) -> bool:
        return channel in self.channels

    @property
    def time(self) -> Array:
        """t [s], strictly increasing."""
        return self.channels["time"]

    @cached_property
    def sample_time(self) -> float:
        """Median step of the clock [s]."""
        return float(np.median(np.diff(self.time)))

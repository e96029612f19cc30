"""A log: the channels of one run in SI, and what its reader changed."""

from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple

from calib.base.arrays import Array
from calib.logs.clock import step_of
from calib.logs.gaps import ChannelHole
from calib.logs.impossible import Marked


@dataclass(frozen=True)
class Origin:
    """A channel [SI] = ``factor`` * its column ``source`` in the file [``unit``] + ``offset``."""

    channel: str
    source: str
    unit: str
    factor: float
    offset: float


class ComputedPressure(NamedTuple):
    """A pressure that was not measured: ``channel`` [bar] = ``factor`` * ``column`` [``unit``]."""

    channel: str
    factor: float
    column: str
    unit: str


@dataclass(frozen=True)
class Log:
    """One run."""

    name: str
    source: str  # path of the file, or the car of a simulation
    digest: str  # SHA-256 of the file, or of the content of a simulation
    channels: dict[str, Array]  # [SI] (n,) by canonical name, among them ``time``
    truth: dict[str, Array] = field(default_factory=dict)  # [SI] (n,) of a simulation, for scores
    ignored: tuple[str, ...] = ()  # columns that are no channels
    notes: tuple[str, ...] = ()  # what the reader changed
    origins: tuple[Origin, ...] = ()
    bridged: tuple[ChannelHole, ...] = ()  # gaps that were filled
    marked: tuple[Marked, ...] = ()  # impossible samples, which were removed
    interpolated: tuple[str, ...] = ()  # channels recorded on another clock than ``time``
    computed: tuple[ComputedPressure, ...] = ()

    def __repr__(self) -> str:
        names = ", ".join(self.channels) + (" + truth" if self.truth else "")
        span = f", {self.time[0]:g} to {self.time[-1]:g} s" if self.time.size else ""
        return f"Log {self.name}: {self.time.size} samples{span}: {names}"

    def __getitem__(self, channel: str) -> Array:
        return self.channels[channel]

    def __contains__(self, channel: str) -> bool:
        return channel in self.channels

    __iter__ = None  # a log in place of a list of logs is a TypeError

    @property
    def time(self) -> Array:
        """t [s], strictly increasing."""
        return self.channels["time"]

    @cached_property
    def sample_time(self) -> float:
        """Mean step of the clock, gaps aside [s]; see `calib.logs.clock`."""
        return step_of(self.time)

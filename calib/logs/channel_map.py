"""A channel map: the columns of a foreign log that are channels, with unit and sign."""

from dataclasses import dataclass
from pathlib import Path

from calib.base.arrays import Array
from calib.base.units import to_si
from calib.logs.text.dialect import LOOKED, TextFormat


@dataclass(frozen=True)
class DatabaseFile:
    """A file that describes frames (DBC, ARXML, KCD or SYM), or one ``bus`` of it."""

    path: Path
    bus: str | None = None


@dataclass(frozen=True)
class Databases:
    """The files of a channel map that describe frames: for every bus of the log, and for one only.

    ``sources`` are source addresses of J1939 messages, found by their parameter group; empty for
    any; None if identifiers must be equal.
    """

    files: tuple[DatabaseFile, ...] = ()
    buses: tuple[tuple[str, tuple[DatabaseFile, ...]], ...] = ()
    sources: tuple[int, ...] | None = None

    @property
    def all(self) -> tuple[DatabaseFile, ...]:
        """All files, in the order of the map."""
        return (*self.files, *(file for _, files in self.buses for file in files))


METHODS = ("linear", "hold")


@dataclass(frozen=True)
class Mapping:
    """Source of one channel: value = sign * (scale * written + offset), in ``unit``.

    The unit of the header, and the method of interpolation of the file, where they are None;
    ``delay`` time by which it was recorded late [s].
    """

    source: str
    unit: str | None = None
    sign: int = 1
    scale: float = 1.0
    offset: float = 0.0
    method: str | None = None
    delay: float = 0.0

    def to_si(self, written: Array, unit: str, si: str) -> Array:
        """Values in SI, shape (n,), from the values in the file. Raises UnknownUnit."""
        return to_si(self.written(written), unit, si)

    def written(self, written: Array) -> Array:
        """Values in the unit of the mapping, shape (n,), from the values in the file."""
        return self.sign * (self.scale * written + self.offset)


@dataclass(frozen=True)
class ChannelMap:
    """The mapped channels by canonical name, and the path of the map; columns to ``ignore``."""

    where: str
    channels: dict[str, Mapping]
    text: TextFormat = LOOKED
    ignore: tuple[str, ...] = ()
    databases: Databases = Databases()

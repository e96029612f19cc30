"""Which files describe the frames of a log: for every bus, or each for one."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class DatabaseFile:
    """A file that describes frames (DBC, ARXML, KCD or SYM).

    ``bus`` is the name that the file has for one of its buses, if only that one is meant.
    """

    path: Path
    bus: str | None = None


@dataclass(frozen=True)
class Databases:
    """The files of a channel map that describe frames.

    Attributes
    ----------
    files : for every bus of the log.
    buses : for one bus only, by the recorder's name of its channel, such as ``"1"`` or ``"can0"``.
    sources : source addresses of J1939 messages, whose frames are then found by their parameter
        group; empty for any address; None if identifiers must be equal.
    """

    files: tuple[DatabaseFile, ...] = ()
    buses: tuple[tuple[str, tuple[DatabaseFile, ...]], ...] = ()
    sources: tuple[int, ...] | None = None

    @property
    def all(self) -> tuple[DatabaseFile, ...]:
        """All files, in the order of the map."""
        return (*self.files, *(file for _, files in self.buses for file in files))

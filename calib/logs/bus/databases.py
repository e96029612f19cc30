"""Which files describe the frames of a log: for every bus, or each for one."""

from dataclasses import dataclass
from pathlib import Path


@dataclass(frozen=True)
class Databases:
    """Files that describe frames (DBC, ARXML, KCD or SYM).

    Attributes
    ----------
    files : for every bus of the log.
    buses : for one bus only, by the recorder's name of its channel, such as ``"1"`` or ``"can0"``.
    sources : source addresses of J1939 messages, whose frames are then found by their parameter
        group; empty for any address; None if identifiers must be equal.
    """

    files: tuple[Path, ...] = ()
    buses: tuple[tuple[str, tuple[Path, ...]], ...] = ()
    sources: tuple[int, ...] | None = None

    @property
    def paths(self) -> tuple[Path, ...]:
        """All files, in the order of the map."""
        return (*self.files, *(path for _, files in self.buses for path in files))

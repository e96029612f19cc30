"""Frames of a bus, grouped by identifier."""

from array import array
from collections.abc import Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from calib.logs.source import Array

if TYPE_CHECKING:
    from can import Message

Key = tuple[int, bool]
"""Identifier, and whether it is extended (29 bits)."""


@dataclass(frozen=True)
class Frames:
    """All frames of one identifier on one bus, in the order of the file.

    ``bus`` is the recorder's name of its channel; ``time`` [s], shape (n,); ``data``
    shape (n, bytes), zero past the end of a frame; ``length`` bytes of each frame, shape (n,).
    """

    bus: str
    key: Key
    time: Array
    data: NDArray[np.uint8]
    length: NDArray[np.uint8]


@dataclass
class Gathered:
    """Frames while a file is read: those that a DBC describes, and the times of all [s]."""

    known: frozenset[Key]
    times: "array[float]" = field(default_factory=lambda: array("d"))
    errors: int = 0
    _place: "dict[tuple[str, Key], array[int]]" = field(default_factory=dict)
    _data: dict[tuple[str, Key], list[bytes]] = field(default_factory=dict)

    def take(self, messages: "Iterable[Message]") -> None:
        """Read all messages. Error and remote frames are counted but have no data."""
        for number, message in enumerate(messages, start=len(self.times)):
            self.times.append(message.timestamp)
            key = (message.arbitration_id, message.is_extended_id)
            if message.is_error_frame:
                self.errors += 1
            elif key in self.known and not message.is_remote_frame:
                origin = (str(message.channel), key)
                if origin not in self._place:
                    self._place[origin], self._data[origin] = array("L"), []
                self._place[origin].append(number)
                self._data[origin].append(bytes(message.data))

    def result(self, time: Array) -> list[Frames]:
        """Frames by bus and identifier; ``time`` [s] replaces `times`, shape (n,)."""
        return [
            frames_of(*origin, time[np.asarray(self._place[origin])], self._data[origin])
            for origin in sorted(self._place)
        ]


def frames_of(bus: str, key: Key, time: Array, data: list[bytes]) -> Frames:
    """Make `Frames` from a list of bytes, one for each frame."""
    length = np.fromiter(map(len, data), np.uint8, len(data))
    width = int(length.max(initial=0))
    padded = b"".join(d.ljust(width, b"\0") for d in data)
    return Frames(bus, key, time, np.frombuffer(padded, np.uint8).reshape(len(data), width), length)

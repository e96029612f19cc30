"""Frames of a bus, grouped by identifier, and what an identifier of 29 bits says in SAE J1939.

28..26    25..24   23..16        15..8                     7..0
priority  page     PDU format    destination or extension  source address
"""

from array import array
from collections.abc import Callable, Hashable, Iterable
from dataclasses import dataclass, field
from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array

if TYPE_CHECKING:
    from can import Message

_BROADCAST = 240
"""PDU formats from here on have no destination: the byte after belongs to the group."""


def group_of(identifier: int) -> int:
    """Parameter group number of an extended identifier, without its destination.

    Source: SAE J1939-21, section 5.2.

    >>> hex(group_of(0x18FEBF0B)), hex(group_of(0x0C002903))  # to all; to 0x29
    ('0xfebf', '0x0')
    """
    group = identifier >> 8 & 0x3FFFF
    return group if group >> 8 & 0xFF >= _BROADCAST else group & 0x3FF00


def source_of(identifier: int) -> int:
    """Source address of an extended identifier."""
    return identifier & 0xFF


Key = tuple[int, bool]
"""Identifier, and whether it is extended (29 bits)."""

Known = Callable[[str, Key], bool]
"""Whether the frames of an identifier on a bus are described."""


@dataclass(frozen=True)
class Frames:
    """All frames of one identifier on one bus, in the order of the file.

    ``time`` [s] (n,); ``data`` (n, bytes), zero past the ``length`` (n,) of a frame; ``order`` (n,)
    is the number of each frame in the file.
    """

    bus: str
    key: Key
    time: Array
    data: NDArray[np.uint8]
    length: NDArray[np.uint16]
    order: NDArray[np.int64]

    def at(self, rows: NDArray[np.intp] | NDArray[np.bool_]) -> "Frames":
        """Some of the frames."""
        time, data, length = self.time[rows], self.data[rows], self.length[rows]
        return Frames(self.bus, self.key, time, data, length, self.order[rows])


@dataclass
class Gathered:
    """Frames while a file is read: those that are ``known``, and the times of all [s]."""

    known: Known
    times: "array[float]" = field(default_factory=lambda: array("d"))
    errors: int = 0
    seen: dict[tuple[str, Key], bool] = field(default_factory=dict)
    _place: "dict[tuple[str, Key], array[int]]" = field(default_factory=dict)
    _data: dict[tuple[str, Key], list[bytes]] = field(default_factory=dict)

    def take(self, messages: "Iterable[Message]") -> None:
        """Read all messages. Error and remote frames are counted but have no data."""
        for number, message in enumerate(messages, start=len(self.times)):
            self.times.append(message.timestamp)
            if message.is_error_frame:
                self.errors += 1
                continue
            origin = (str(message.channel), (message.arbitration_id, message.is_extended_id))
            if origin not in self.seen:
                self.seen[origin] = self.known(*origin)
                self._place[origin], self._data[origin] = array("L"), []
            if self.seen[origin] and not message.is_remote_frame:
                self._place[origin].append(number)
                self._data[origin].append(bytes(message.data))

    @property
    def buses(self) -> list[str]:
        """All buses of the log."""
        return sorted({bus for bus, _ in self.seen})

    def result(self, time: Array) -> list[Frames]:
        """Frames by bus and identifier; ``time`` [s] replaces `times`, shape (n,)."""
        return [
            frames_of(*origin, time[place], self._data[origin], place)
            for origin in sorted(self._place)
            if (place := np.asarray(self._place[origin], np.int64)).size
        ]


def frames_of(
    bus: str, key: Key, time: Array, data: list[bytes], order: NDArray[np.int64] | None = None
) -> Frames:
    """Make `Frames` from a list of bytes, one for each frame; ``order``: that of the list."""
    order = np.arange(len(data)) if order is None else order
    length = np.fromiter(map(len, data), np.uint16, len(data))
    width = int(length.max(initial=0))
    padded = b"".join(d.ljust(width, b"\0") for d in data)
    table = np.frombuffer(padded, np.uint8).reshape(len(data), width)
    return Frames(bus, key, time, table, length, order)


AT_ONCE, MANY = 0.25, 0.4
"""A double follows within this share of the spacing of a message; of a message that is recorded
twice this share of the frames, about half of them, are doubles [1]."""


def once(frames: list[Frames]) -> tuple[list[Frames], list[str]]:
    """Messages of which each frame was recorded twice, without the second ones; and a note."""
    doubled = [_doubles(item) for item in frames]
    left = sum(int(np.count_nonzero(mask)) for mask in doubled)
    if not left:
        return frames, []
    several = sum(bool(mask.any()) for mask in doubled)
    total = sum(item.time.size for item in frames)
    note = (
        f"doubled frames: {left} of {total}, of {several} identifiers, have the bytes of the frame "
        "before them and follow it at once; they were left out. Was one bus recorded twice, or a "
        "frame both when sent and when received?"
    )
    return [item.at(~mask) for item, mask in zip(frames, doubled, strict=True)], [note]


def _doubles(frames: Frames) -> NDArray[np.bool_]:
    at = np.lexsort((frames.order, frames.time))
    ordered = frames.at(at)
    time, data, length = ordered.time, ordered.data, ordered.length
    mask = np.zeros(time.size, bool)
    if time.size < 4:
        return mask
    same = (data[1:] == data[:-1]).all(axis=1) & (length[1:] == length[:-1])
    found = same & (np.diff(time) < AT_ONCE * float(np.median(time[2:] - time[:-2])))
    if np.count_nonzero(found) > MANY * time.size:
        mask[at[1:][found]] = True
    return mask


def joined(frames: Iterable[Frames], same: Callable[[Frames], Hashable]) -> list[Frames]:
    """Join frames with an equal value of ``same``, in the order of time; named after the first."""
    parts: dict[Hashable, list[Frames]] = {}
    for item in frames:
        parts.setdefault(same(item), []).append(item)
    return [_one(items) if len(items) > 1 else items[0] for items in parts.values()]


def _one(items: list[Frames]) -> Frames:
    width = max(item.data.shape[1] for item in items)
    data = [np.pad(item.data, ((0, 0), (0, width - item.data.shape[1]))) for item in items]
    every = Frames(
        items[0].bus,
        items[0].key,
        np.concatenate([item.time for item in items]),
        np.concatenate(data),
        np.concatenate([item.length for item in items]),
        np.concatenate([item.order for item in items]),
    )
    return every.at(np.lexsort((every.order, every.time)))

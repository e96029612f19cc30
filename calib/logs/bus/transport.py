"""J1939 messages of more than 8 bytes, put together from the frames that carry them.

    sender    RTS, or BAM to all: group, bytes, frames      group `CONNECTION`
    receiver      CTS: frames from number n on, please
    sender    1 b b b b b b b                               group `TRANSFER`
    sender    2 b b b b b b b
    receiver      end: I have it

Source: SAE J1939-21, section 5.10. One sender has one message at a time for each destination. A
message counts from its announcement, when its content was made. One that lacks a frame, or whose
frames are not in order, is left out and told.
"""

from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass, field

import numpy as np

from calib.logs.bus.dbc import Dbc
from calib.logs.bus.frames import Frames, frames_of, joined
from calib.logs.bus.j1939 import (
    BROADCAST,
    CONNECTION,
    destination_of,
    group_of,
    source_of,
)

RTS, BAM = 16, 32
"""First byte of the frame that announces a message to one address, and to all."""
CTS, END, ABORT = 17, 19, 255
"""First byte of the frames by which the receiver asks and confirms, and either side gives up."""

PAUSE = 1.25
"""Longest pause between the frames of one message [s]: the longest time-out of J1939-21, T2."""

CARRIED = 7
"""Bytes of the message in a frame."""

Link = tuple[str, int, int]
"""Bus, source and destination of a message."""


@dataclass
class _Message:
    """A message while its frames come; ``wanted`` is the number of the next one."""

    group: int
    size: int
    frames: int
    to_all: bool
    time: float
    order: int
    last: float
    wanted: int = 1
    parts: dict[int, bytes] = field(default_factory=dict)

    @property
    def possible(self) -> bool:
        return self.size > CARRIED + 1 and self.frames == -(-self.size // CARRIED)

    @property
    def whole(self) -> bool:
        return self.possible and len(self.parts) == self.frames

    @property
    def data(self) -> bytes:
        return b"".join(self.parts[i + 1] for i in range(self.frames))[: self.size]


@dataclass(frozen=True)
class _Whole:
    """A message that is whole: announced at ``time`` [s], as frame number ``order``."""

    link: Link
    group: int
    time: float
    order: int
    data: bytes

    @property
    def identifier(self) -> int:
        """The identifier that one frame with this content would have, at priority 6."""
        _, source, destination = self.link
        to_one = self.group >> 8 & 0xFF < BROADCAST
        return 6 << 26 | self.group << 8 | (destination << 8 if to_one else 0) | source


def put_together(frames: list[Frames], dbc: Dbc) -> tuple[list[Frames], list[str]]:
    """Replace the frames that carry messages of ``dbc`` by these messages; and notes on them."""
    carriers = [item for item in frames if dbc.carries(item.key)]
    if not carriers:
        return frames, []
    whole, lost = Counter[str](), Counter[str]()
    made: dict[tuple[str, int], list[_Whole]] = {}

    def lose(link: Link, message: _Message) -> None:
        if described := dbc.of_group(link[0], message.group):
            lost[described.name] += 1

    for one in _messages(carriers, dbc, lose):
        if described := dbc.find(one.link[0], (one.identifier, True)):
            whole[described.name] += 1
            made.setdefault((one.link[0], one.identifier), []).append(one)
    others = [item for item in frames if not dbc.carries(item.key) or dbc.find(item.bus, item.key)]
    built = [_frames(bus, identifier, found) for (bus, identifier), found in made.items()]
    return joined([*others, *built], lambda item: (item.bus, item.key)), [
        f"{what}: {', '.join(f'{count} x {name}' for name, count in sorted(names.items()))}"
        for what, names in (
            ("J1939 messages of several frames were put together", whole),
            ("J1939 messages that lack one of their frames were left out", lost),
        )
        if names
    ]


def _frames(bus: str, identifier: int, found: list[_Whole]) -> Frames:
    found.sort(key=lambda one: (one.time, one.order))
    times, order = np.array([one.time for one in found]), np.array([one.order for one in found])
    return frames_of(bus, (identifier, True), times, [one.data for one in found], order)


def _messages(
    carriers: list[Frames], dbc: Dbc, lose: Callable[[Link, _Message], None]
) -> Iterator[_Whole]:
    """Every message that is whole; ``lose`` is called for the others."""
    open_: dict[Link, _Message] = {}

    def end(link: Link) -> Iterator[_Whole]:
        message = open_.pop(link, None)
        if message and message.whole:
            yield _Whole(link, message.group, message.time, message.order, message.data)
        elif message:
            lose(link, message)

    for bus, identifier, time, order, data in _in_order(carriers):
        source, destination = source_of(identifier), destination_of(identifier)
        sent, answered = (bus, source, destination), (bus, destination, source)
        if group_of(identifier) != CONNECTION:
            message = open_.get(sent)
            if message and not _taken(message, time, data):
                lose(sent, open_.pop(sent))
            elif message and message.whole and message.to_all:
                yield from end(sent)
        elif data[0] in (RTS, BAM):
            yield from end(sent)
            if dbc.listens_to(source):
                open_[sent] = _announced(data, time, order)
        elif data[0] == CTS:
            _asked(open_.get(answered), time, data)
        elif data[0] == END:
            yield from end(answered)
        elif data[0] == ABORT:
            for link in (sent, answered):
                if link in open_ and open_[link].group == _group(data):
                    lose(link, open_.pop(link))
    for link in list(open_):
        yield from end(link)


def _in_order(carriers: list[Frames]) -> Iterator[tuple[str, int, float, int, bytes]]:
    """Bus, identifier, time, number and the 8 bytes of every frame, in the order of time."""
    whole = [item.length == CARRIED + 1 for item in carriers]
    which = np.concatenate([np.full(int(m.sum()), i) for i, m in enumerate(whole)])
    time = np.concatenate([item.time[m] for item, m in zip(carriers, whole, strict=True)])
    order = np.concatenate([item.order[m] for item, m in zip(carriers, whole, strict=True)])
    data = [d for item, m in zip(carriers, whole, strict=True) for d in item.data[m, :8]]
    for i in np.lexsort((order, time)).tolist():
        item = carriers[which[i]]
        yield item.bus, item.key[0], float(time[i]), int(order[i]), data[i].tobytes()


def _group(data: bytes) -> int:
    """The parameter group that a frame of a connection names."""
    return int.from_bytes(data[5:8], "little") & 0x3FFFF


def _announced(data: bytes, time: float, order: int) -> _Message:
    size = int.from_bytes(data[1:3], "little")
    return _Message(_group(data), size, data[3], data[0] == BAM, time, order, time)


def _asked(message: _Message | None, time: float, data: bytes) -> None:
    """The receiver asks for frames from a number on, maybe again; or to wait, where it wants 0."""
    if message is not None:
        message.last = time
        if data[1] and data[2]:
            message.wanted = data[2]


def _taken(message: _Message, time: float, data: bytes) -> bool:
    """Take a frame; whether it is the wanted one, in time, of a message that can be."""
    if not message.possible or data[0] != message.wanted or time - message.last > PAUSE:
        return False
    message.parts[data[0]] = data[1:]
    message.wanted, message.last = data[0] + 1, time
    return True

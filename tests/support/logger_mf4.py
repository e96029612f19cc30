"""MF4 as CAN loggers write it, byte by byte, after the public files of CSS Electronics.

One data group with records of several groups, each with an identifier of one byte. The identifier
of a frame has 11 bits in 16; data bytes are in the record, or in a VLSD group of their own.
"""

import struct
from collections.abc import Sequence
from dataclasses import dataclass, field
from itertools import pairwise

UINT, REAL, BYTES = 0, 4, 10
FLAGS = 0x25
"""Counts, length of the last DT and sizes of VLSD groups are not final."""
FRAME = struct.Struct("<BdBHB")
VLSD_FRAME = struct.Struct("<BdBHBQ")


@dataclass(frozen=True)
class Row:
    """One frame: time [s], bus, identifier, data; ``sent`` frames are in a group of their own."""

    time: float
    bus: int
    identifier: int
    data: bytes
    sent: bool = False


@dataclass
class _File:
    data: bytearray = field(default_factory=bytearray)

    def block(self, kind: str, links: Sequence[int], content: bytes) -> int:
        place = len(self.data)
        size = 24 + 8 * len(links) + len(content)
        self.data += struct.pack(f"<4s4xQQ{len(links)}Q", kind.encode(), size, len(links), *links)
        self.data += content + bytes(-len(content) % 8)
        return place

    def text(self, words: str) -> int:
        raw = words.encode() + b"\0"
        return self.block("##TX", (), raw + bytes(-len(raw) % 8))

    def link(self, place: int, number: int, target: int) -> None:
        struct.pack_into("<Q", self.data, place + 24 + 8 * number, target)

    def channel(
        self, name: str, kind: int, byte: int, bits: int, master: bool = False, vlsd: int = 0
    ) -> int:
        links = (0, 0, self.text(name), 0, 0, vlsd, 0, 0)
        role = 2 if master else 1 if vlsd else 0
        head = struct.pack("<BBBBLLLLBBHdddddd", role, int(master), kind, 0, byte, bits, 0, 0,
                           0, 0, 0, *[0.0] * 6)  # fmt: skip
        return self.block("##CN", links, head)

    def group(self, number: int, name: str, size: int, flags: int, following: int = 0) -> int:
        source = self.block("##SI", (self.text("CAN"), 0, 0), struct.pack("<BBB5x", 2, 2, 0))
        links = (following, 0, self.text(name) if name else 0, source if name else 0, 0, 0)
        content = struct.pack("<QQHHLLL", number, 0, flags, 0, 0, size, 0)
        return self.block("##CG", links, content)


def logger_mf4(rows: Sequence[Row], vlsd: bool = False, flags: int = FLAGS) -> bytes:
    """An unfinished file: no counts, and a DT whose length is that of its header."""
    file = _File(bytearray(struct.pack("<8s8s8s4xH30xHH", b"UnFinMF ", b"4.11    ", b"logger  ",
                                       411, flags, 0)))  # fmt: skip
    head = file.block("##HD", [0] * 6, bytes(32))
    groups = [file.group(4, "", 0, 1)] if vlsd else [0]
    groups.append(file.group(3, "", 0, 1, groups[0]) if vlsd else 0)
    sent = _frames(file, 2, "CAN_Tx", groups[0], groups[1])
    received = _frames(file, 1, "CAN_Rx", groups[1], sent)
    group = file.block("##DG", (0, received, 0, 0), struct.pack("<B7x", 1))
    file.link(head, 0, group)
    file.link(group, 2, file.block("##DT", (), b""))
    offsets = [0, 0]
    for row in rows:
        number, begin = 2 if row.sent else 1, (row.time, row.bus, row.identifier, len(row.data))
        if vlsd:
            file.data += struct.pack("<BL", 3 + row.sent, len(row.data)) + row.data
            file.data += VLSD_FRAME.pack(number, *begin, offsets[row.sent])
            offsets[row.sent] += 4 + len(row.data)
        else:
            file.data += FRAME.pack(number, *begin) + row.data.ljust(8, b"\0")
    return bytes(file.data)


def _frames(file: _File, number: int, name: str, vlsd: int, following: int) -> int:
    """A group of data frames: time, and the parts of a frame as components of one channel."""
    clock = file.channel("Timestamp", REAL, 0, 64, master=True)
    whole = file.channel("CAN_DataFrame", BYTES, 8, 96)
    parts = [
        file.channel("CAN_DataFrame.BusChannel", UINT, 8, 8),
        file.channel("CAN_DataFrame.ID", UINT, 9, 11),
        file.channel("CAN_DataFrame.DataLength", UINT, 11, 8),
        file.channel("CAN_DataFrame.DataBytes", BYTES, 12, 64, vlsd=vlsd),
    ]
    for one, next_one in pairwise(parts):
        file.link(one, 0, next_one)
    file.link(clock, 0, whole)
    file.link(whole, 1, parts[0])
    group = file.group(number, name, 20, 6, following)
    file.link(group, 1, clock)
    return group

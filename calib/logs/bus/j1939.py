"""SAE J1939: what an identifier of 29 bits says, and messages that take several frames.

28..26    25..24   23..16        15..8                     7..0
priority  page     PDU format    destination or extension  source address

A message of more than 8 bytes is announced by one frame, and follows in frames of 7 bytes each:
byte 0            1..2  3       4           5..7
32 or 16          size  frames  255 or any  parameter group, lowest byte first
"""

import numpy as np
from numpy.typing import NDArray

BROADCAST = 240
"""PDU formats from here on have no destination: the byte after belongs to the group."""


def group_of(identifier: int) -> int:
    """Parameter group number of an extended identifier, without its destination.

    Source: SAE J1939-21, section 5.2.

    >>> hex(group_of(0x18FEBF0B)), hex(group_of(0x0C002903))  # to all; to 0x29
    ('0xfebf', '0x0')
    """
    group = identifier >> 8 & 0x3FFFF
    return group if group >> 8 & 0xFF >= BROADCAST else group & 0x3FF00


CONNECTION = 0xEC00
"""Parameter group of the frames that announce (and confirm, and end) a message of several."""

_ANNOUNCES = (16, 32)
"""First byte of such a frame: to one address (RTS), and to all (BAM)."""


def announced(data: NDArray[np.uint8], length: NDArray[np.uint8]) -> NDArray[np.int64]:
    """Parameter groups of the messages that frames of the group `CONNECTION` announce.

    ``data`` shape (n, bytes), ``length`` [bytes] shape (n,). Source: SAE J1939-21, section 5.10.

    >>> bam = bytes([32, 17, 0, 3, 255, 0xEC, 0xFE, 0])  # ISO 11783 and J1939: 17 bytes of 65260
    >>> announced(np.frombuffer(bam, np.uint8)[None], np.array([8], np.uint8))
    array([65260])
    """
    data = data[length == 8]
    if not len(data):
        return np.zeros(0, np.int64)
    data = data[np.isin(data[:, 0], _ANNOUNCES)].astype(np.int64)
    return data[:, 5] | data[:, 6] << 8 | (data[:, 7] & 3) << 16


def source_of(identifier: int) -> int:
    """Source address of an extended identifier.

    >>> source_of(0x18FEBF0B)
    11
    """
    return identifier & 0xFF

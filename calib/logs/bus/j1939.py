"""SAE J1939: what an identifier of 29 bits says.

28..26    25..24   23..16        15..8                     7..0
priority  page     PDU format    destination or extension  source address
"""

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


def source_of(identifier: int) -> int:
    """Source address of an extended identifier.

    >>> source_of(0x18FEBF0B)
    11
    """
    return identifier & 0xFF

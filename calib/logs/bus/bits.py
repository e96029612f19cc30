"""Extract a signal from the bytes of many frames at once.

little endian: start is the lowest bit        big endian: start is the highest bit
byte 0  7 6 5 4 3 2 1 0                       byte 0  7 6 5 4 3 2 1 0
        . . . < - - - s   rest in byte 1              . . . s - - - >   rest in byte 1
byte 1 15 . . . . . . 8                       byte 1 15 . . . . . . 8
"""

import numpy as np
from numpy.typing import NDArray

from calib.logs.source import Array

Bytes = NDArray[np.uint8]


def raw(data: Bytes, start: int, length: int, little: bool) -> NDArray[np.uint64]:
    """Unsigned integers of ``length`` bits, shape (n,), from frames of shape (n, bytes).

    ``start`` counts as in a DBC: bit 8 b + k is bit k of byte b. All bytes must be present.

    >>> raw(np.array([[0x34, 0x12]], np.uint8), 0, 16, little=True)
    array([4660], dtype=uint64)
    >>> raw(np.array([[0x12, 0x34]], np.uint8), 7, 16, little=False)
    array([4660], dtype=uint64)
    """
    first, bit = divmod(start, 8)
    value = np.zeros(len(data), np.uint64)
    if little:
        for place, byte in enumerate(range(first, (start + length - 1) // 8 + 1)):
            shift = 8 * place - bit
            column = data[:, byte].astype(np.uint64)
            value |= column << np.uint64(shift) if shift >= 0 else column >> np.uint64(-shift)
        return value & _mask(length)
    left, byte = length - (bit + 1), first
    value |= data[:, byte].astype(np.uint64) & _mask(bit + 1)
    while left > 0:
        byte, take = byte + 1, min(left, 8)
        column = data[:, byte].astype(np.uint64) >> np.uint64(8 - take)
        value = (value << np.uint64(take)) | column
        left -= take
    return value >> np.uint64(max(-left, 0))


def last_byte(start: int, length: int, little: bool) -> int:
    """Index of the last byte of a frame that a signal uses."""
    if little:
        return (start + length - 1) // 8
    first, bit = divmod(start, 8)
    return first + max(0, -(-(length - bit - 1) // 8))


def number(value: NDArray[np.uint64], length: int, signed: bool, real: bool) -> Array:
    """Values of raw integers of ``length`` bits: unsigned, two's complement or IEEE 754."""
    if real:
        kinds: dict[int, tuple[type, type]] = {
            16: (np.uint16, np.float16),
            32: (np.uint32, np.float32),
            64: (np.uint64, np.float64),
        }
        integer, floating = kinds[length]
        return value.astype(integer).view(floating).astype(np.float64)
    if not signed:
        return value.astype(np.float64)
    unused = np.uint64(64 - length)
    return ((value << unused).view(np.int64) >> np.int64(64 - length)).astype(np.float64)


def _mask(length: int) -> np.uint64:
    return np.uint64(2**length - 1)

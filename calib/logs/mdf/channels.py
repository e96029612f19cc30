"""Check that every channel of an MDF 4 file lies within the records of its group.

asammdf reads the bytes without looking, some of them when it opens the file.
"""

import mmap
import struct
from collections.abc import Iterator
from pathlib import Path

from calib.errors import LogError
from calib.logs.mdf.blocks import Bytes, block_at, chain, whole_blocks

_FIRST = 64
_GROUP = struct.Struct("<24xLL")
_CHANNEL = struct.Struct("<3xBLL")


def check_channels(path: Path) -> None:
    """Raise LogError for a channel outside its record.

    `calib.logs.mdf.size.check_size` must have accepted the file.
    """
    with (
        path.open("rb") as file,
        mmap.mmap(file.fileno(), 0, access=mmap.ACCESS_READ) as data,
        whole_blocks(path),
    ):
        _check(data, path)


def _check(data: Bytes, path: Path) -> None:
    for place in chain(data, block_at(data, _FIRST).links[0]):
        for group in chain(data, block_at(data, place).links[1]):
            block = block_at(data, group)
            size = sum(_GROUP.unpack_from(data, block.content))
            for channel in _channels(data, block.links[1]):
                bit, byte, bits = _CHANNEL.unpack_from(data, block_at(data, channel).content)
                if 8 * byte + bit + bits > 8 * size:
                    raise LogError(
                        f"the channel at byte {channel} lies outside the records of its group",
                        where=path,
                        expected=f"bits within {size} bytes",
                        do="the file is damaged: copy the log again",
                    )


def _channels(data: Bytes, first: int) -> Iterator[int]:
    """Channels of a group, and those of which a channel is composed."""
    seen, todo = set[int](), [first]
    while todo:
        for place in chain(data, todo.pop()):
            block = block_at(data, place)
            if place in seen or block.kind != b"##CN":
                break
            seen.add(place)
            yield place
            todo.append(block.links[1])

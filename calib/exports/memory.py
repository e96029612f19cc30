"""What a linked program says about its memory: symbols by name, byte order, where it stands.

`calib.exports.elf` and `calib.exports.linker_map` read it, `calib.exports.addresses` judges it.
"""

from dataclasses import dataclass


@dataclass(frozen=True)
class Symbol:
    """A symbol at ``address``; ``size`` [byte] and ``content`` are None where the file has none."""

    address: int
    size: int | None = None
    content: bytes | None = None


@dataclass(frozen=True)
class EcuSymbols:
    """The wanted symbols that a file has; ``big_endian`` is None where the file does not tell.

    ``remarks`` are sentences for the user about what the file leaves open.
    """

    symbols: dict[str, Symbol]
    big_endian: bool | None
    remarks: tuple[str, ...] = ()

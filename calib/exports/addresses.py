"""Where the objects of the C header are in the memory of the ECU, from the linked program.

The names are the labels. An object whose size or bytes in the program differ from those of the
export is refused: the program holds another table, other points or another width.
"""

from dataclasses import dataclass, field
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calib.errors import ProgramError
from calib.exports.dataset import Dataset
from calib.exports.elf import MAGIC, read_elf
from calib.exports.fixed_point import fixed_axis, to_fixed
from calib.exports.linker_map import read_map
from calib.exports.memory import EcuSymbols

Numbers = NDArray[np.float64] | NDArray[np.signedinteger]

LARGEST_FILE = 512 * 1024**2
"""Largest program or map file [byte]."""

LARGEST_ADDRESS = 0xFFFF_FFFF
"""A2L holds addresses of 32 bits."""

NONE_GIVEN = (
    "all addresses are 0 and little endian is assumed: `tables export --elf FILE` takes them from "
    "the linked program or its map file"
)


@dataclass(frozen=True)
class Addresses:
    """Address of each object by label, and the byte order; all are 0 where no file was given.

    ``remarks`` say what was assumed, in sentences.
    """

    by_label: dict[str, int] = field(default_factory=dict)
    big_endian: bool = False
    remarks: tuple[str, ...] = (NONE_GIVEN,)

    def of(self, name: str) -> int:
        """Address of an object."""
        return self.by_label.get(name, 0)


def find_addresses(path: Path, data: Dataset, bits: int | None) -> Addresses:
    """Addresses of all objects of ``data``, in double or integers of ``bits``, in a program.

    Raises ProgramError where the file cannot be read, misses an object or holds another table.
    """
    numbers = numbers_in_memory(data, bits)
    memory = _read(path, set(numbers))
    _check_present(path, data, memory, numbers)
    _check_sizes(path, memory, numbers)
    _check_numbers(path, data, memory, numbers)
    remarks = tuple(f"{path.name}: {remark}" for remark in memory.remarks)
    found = {name: memory.symbols[name].address for name in numbers}
    for name, at in found.items():
        if at > LARGEST_ADDRESS:
            raise ProgramError(
                f"{name} is at 0x{at:X}", where=path, expected="addresses of 32 bits, as A2L has"
            )
    return Addresses(found, bool(memory.big_endian), remarks)


def numbers_in_memory(data: Dataset, bits: int | None) -> dict[str, Numbers]:
    """The numbers of each object of the C header by label, in their type in C; shapes (n,)."""
    if bits is None:
        return {
            **{a.label: a.values for a in data.axes},
            **{c.label: c.values for c in data.curves},
            **{s.label: np.array([s.value]) for s in data.scalars},
        }
    fixed = {
        **{a.label: fixed_axis(a, bits) for a in data.axes},
        **{c.label: to_fixed(c.values, bits) for c in data.curves},
        **{s.label: to_fixed(np.array([s.value]), bits) for s in data.scalars},
    }
    return {name: one.raw.astype(f"i{bits // 8}") for name, one in fixed.items()}


def _read(path: Path, wanted: set[str]) -> EcuSymbols:
    if path.exists() and not path.is_file():
        raise ProgramError("is not a regular file", where=path, expected="an ELF or map file")
    try:
        size = path.stat().st_size
        if size > LARGEST_FILE:
            raise ProgramError(
                f"has {size} bytes",
                where=path,
                expected=f"at most {LARGEST_FILE}",
                do="take a copy without debug information (`strip --strip-debug`)",
            )
        content = path.read_bytes()
    except OSError as error:
        raise ProgramError(f"cannot be read ({error.strerror})", where=path) from error
    read = read_elf if content.startswith(MAGIC) else read_map
    return read(path, content, wanted)


def _check_present(
    path: Path, data: Dataset, memory: EcuSymbols, numbers: dict[str, Numbers]
) -> None:
    missing = [name for name in numbers if name not in memory.symbols]
    if missing:
        more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        raise ProgramError(
            f"has no symbol {missing[0]}{more}",
            where=path,
            expected="every object of the C header",
            do=f"define {data.prefix.upper()}_DEFINE before the header in one source file, and "
            "keep what no code reads from the linker (KEEP in its script, or no --gc-sections)",
        )


def _check_sizes(path: Path, memory: EcuSymbols, numbers: dict[str, Numbers]) -> None:
    for name, values in numbers.items():
        found = memory.symbols[name].size
        if found not in (None, values.nbytes):
            raise ProgramError(
                f"{name} has {found} bytes",
                where=path,
                expected=f"{values.nbytes}",
                do="give the --points and --fixed-point of the C header that the program has",
            )


def _check_numbers(
    path: Path, data: Dataset, memory: EcuSymbols, numbers: dict[str, Numbers]
) -> None:
    for name, values in numbers.items():
        content = memory.symbols[name].content
        kind = values.dtype.newbyteorder(">" if memory.big_endian else "<")
        if content not in (None, values.astype(kind).tobytes()):
            raise ProgramError(
                f"holds other numbers in {name}",
                where=path,
                expected=f"those of {data.id}",
                do="export the version that the program holds, or build the program again",
            )

"""Where the objects of the C header are in the memory of the ECU, from the linked program.

The names are the labels. An object whose size or bytes in the program differ from those of the
export is refused: the program holds another table, other points or another width.
"""

from collections.abc import Collection
from dataclasses import dataclass, field
from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.base.errors import ProgramError
from calib.exports.dataset import Dataset
from calib.exports.fixed_point import fixed_objects

Numbers = NDArray[np.float64] | NDArray[np.signedinteger]

LARGEST_FILE = 512 * 1024**2
"""Largest program [byte]."""

LARGEST_OBJECT = 1 << 16
"""Largest object whose bytes are read [byte]."""

LARGEST_ADDRESS = 0xFFFF_FFFF
"""A2L holds addresses of 32 bits."""

NONE_GIVEN = (
    "all addresses are 0 and little endian is assumed: `tables export --elf FILE` takes them from "
    "the linked program"
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


@dataclass(frozen=True)
class _Symbol:
    """An object in a program; ``content`` is None where the file does not hold its bytes."""

    address: int
    size: int
    content: bytes | None


def find_addresses(path: Path, data: Dataset, bits: int | None) -> Addresses:
    """Addresses of all objects of ``data``, in double or integers of ``bits``, in a program.

    Raises ProgramError where the file cannot be read, misses an object or holds another table.
    """
    numbers = numbers_in_memory(data, bits)
    symbols, big_endian, remarks = _read(path, set(numbers))
    _check_present(path, data, symbols, numbers)
    for name, values in numbers.items():
        _check_same(path, data, name, symbols[name], values, big_endian)
    return Addresses({name: symbols[name].address for name in numbers}, big_endian, remarks)


def numbers_in_memory(data: Dataset, bits: int | None) -> dict[str, Numbers]:
    """The numbers of each object of the C header by label, in their type in C; shapes (n,)."""
    if bits is None:
        return {**data.arrays}
    return {
        name: one.raw.astype(f"i{bits // 8}") for name, one in fixed_objects(data, bits).items()
    }


def _read(path: Path, wanted: set[str]) -> tuple[dict[str, _Symbol], bool, tuple[str, ...]]:
    """The symbols of these names, whether the program is big endian, and remarks."""
    if path.exists() and not path.is_file():
        raise ProgramError("is not a regular file", where=path, expected="an ELF file")
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
    if not content.startswith(b"\x7fELF"):
        raise ProgramError(
            "is no ELF file",
            where=path,
            expected="the linked program, and no map file of its linker",
        )
    from elftools.elf.elffile import ELFFile

    try:
        elf = ELFFile(BytesIO(content))
        found = _symbols(path, elf, wanted)
    except ProgramError:
        raise
    except Exception as cause:  # a damaged file makes pyelftools raise almost anything
        raise ProgramError(
            f"is damaged: {str(cause) or type(cause).__name__}",
            where=path,
            do="copy or link it again",
        ) from cause
    moved = "it is position-independent: its addresses count from where it is loaded"
    remarks = (f"{path.name}: {moved}",) if elf["e_type"] == "ET_DYN" else ()
    return found, not elf.little_endian, remarks


def _symbols(path: Path, elf: Any, wanted: Collection[str]) -> dict[str, _Symbol]:
    """The global, defined symbols of data. Raises ProgramError without a symbol table."""
    if elf["e_type"] == "ET_REL":
        raise ProgramError(
            "is an object file, whose addresses are not fixed yet",
            where=path,
            expected="the linked program",
        )
    tables = list(elf.iter_sections("SHT_SYMTAB"))
    if not tables:
        raise ProgramError(
            "has no symbol table",
            where=path,
            expected="the program as the linker wrote it",
            do="take the file from before `strip`",
        )
    return {
        symbol.name: _symbol(path, elf, symbol)
        for table in tables
        for symbol in table.iter_symbols()
        if symbol.name in wanted
        and symbol["st_shndx"] != "SHN_UNDEF"
        and symbol["st_info"]["bind"] in ("STB_GLOBAL", "STB_WEAK")
        and symbol["st_info"]["type"] in ("STT_NOTYPE", "STT_OBJECT")
    }


def _symbol(path: Path, elf: Any, symbol: Any) -> _Symbol:
    address, size, home = symbol["st_value"], symbol["st_size"], symbol["st_shndx"]
    if not isinstance(home, int) or size > LARGEST_OBJECT:
        return _Symbol(address, size, None)
    section = elf.get_section(home)
    begin = address - section["sh_addr"]
    if not 0 <= begin <= section["sh_size"] - size:
        raise ProgramError("is damaged: a symbol lies outside its section", where=path)
    if section["sh_type"] != "SHT_PROGBITS":
        return _Symbol(address, size, None)
    content = section.data()[begin : begin + size]
    if len(content) < size:
        raise ProgramError("is cut off", where=path, do="copy or link it again")
    return _Symbol(address, size, content)


def _check_present(
    path: Path, data: Dataset, symbols: dict[str, _Symbol], numbers: dict[str, Numbers]
) -> None:
    missing = [name for name in numbers if name not in symbols]
    if missing:
        more = f" and {len(missing) - 1} more" if len(missing) > 1 else ""
        raise ProgramError(
            f"has no symbol {missing[0]}{more}",
            where=path,
            expected="every object of the C header",
            do=f"define {data.prefix.upper()}_DEFINE before the header in one source file, and "
            "keep what no code reads from the linker (KEEP in its script, or no --gc-sections)",
        )


def _check_same(
    path: Path, data: Dataset, name: str, symbol: _Symbol, values: Numbers, big_endian: bool
) -> None:
    if symbol.size != values.nbytes:
        raise ProgramError(
            f"{name} has {symbol.size} bytes",
            where=path,
            expected=f"{values.nbytes}",
            do="give the --points and --fixed-point of the C header that the program has",
        )
    kind = values.dtype.newbyteorder(">" if big_endian else "<")
    if symbol.content not in (None, values.astype(kind).tobytes()):
        raise ProgramError(
            f"holds other numbers in {name}",
            where=path,
            expected=f"those of {data.id}",
            do="export the version that the program holds, or build the program again",
        )
    if symbol.address > LARGEST_ADDRESS:
        raise ProgramError(
            f"{name} is at 0x{symbol.address:X}",
            where=path,
            expected="addresses of 32 bits, as A2L has",
        )

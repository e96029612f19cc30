"""Find the addresses of exported objects in the linked program of an ECU.

Each object has a symbol with its label. An object of another size or content than the export has
is refused, since the program then holds another table, other points or another width.
"""

from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np

from calib.base.bounded import PROGRAM, bytes_of
from calib.base.errors import ProgramError
from calib.base.extras import need
from calib.exports.dataset import Dataset, Object
from calib.exports.symbols import Addresses, Within

_LARGEST_ADDRESS = 0xFFFF_FFFF  # A2L holds addresses of 32 bits


def find_addresses(path: Path, data: Dataset) -> Addresses:
    """Return the addresses of all objects of ``data`` in a program.

    Raises ProgramError where the file cannot be read, misses an object or holds another table.
    """
    ELFFile = need("elftools.elf.elffile", "elf", path, ProgramError).ELFFile
    content = bytes_of(path, PROGRAM, ProgramError, "the linked program (ELF)")
    if not content.startswith(b"\x7fELF"):
        expected = "the linked program, and no map file of its linker"
        raise ProgramError("is no ELF file", where=path, expected=expected)
    try:
        elf = ELFFile(BytesIO(content))
        symbols = _symbols(path, elf, data)
        for constant in data.objects:
            _check_same(path, data, constant, elf, symbols[constant.place.symbol])
        places = {x.label: x.place for x in data.objects} | {data.epk: Within(data.epk)}
        places |= {x.label: x.within for x in data.measured}
        by_label = {
            name: int(symbols[place.symbol]["st_value"]) + place.offset
            for name, place in places.items()
            if place.symbol in symbols
        }
    except ProgramError:
        raise
    except Exception as cause:  # a damaged file makes pyelftools raise almost anything
        message = f"is damaged: {str(cause) or type(cause).__name__}"
        raise ProgramError(message, where=path, do="copy or link it again") from cause
    remarks = []
    if elf["e_type"] == "ET_DYN":
        moved = "it is position-independent: its addresses count from where it is loaded"
        remarks.append(f"{path.name}: {moved}")
    absent = {x.within.symbol for x in data.measured} - symbols.keys()
    if absent:
        remarks.append(f"{path.name}: no {', '.join(absent)}: measurements have no address")
    constants = [symbols[x.place.symbol] for x in data.objects]
    begin = min(x["st_value"] for x in constants)
    end = max(x["st_value"] + x["st_size"] for x in constants)
    return Addresses(by_label, (begin, end - begin), not elf.little_endian, tuple(remarks))


def _symbols(path: Path, elf: Any, data: Dataset) -> dict[str, Any]:
    """Return the global, defined symbols of the objects by name. Measured ones may be missing."""
    tables = list(elf.iter_sections("SHT_SYMTAB"))
    if not tables or elf["e_type"] == "ET_REL":
        expected = "the linked program as the linker wrote it, before `strip`"
        raise ProgramError("has no symbols at fixed addresses", where=path, expected=expected)
    needed = {x.place.symbol for x in data.objects}
    wanted = needed | {x.within.symbol for x in data.measured} | {data.epk}
    by_name = {
        symbol.name: symbol
        for table in tables
        for symbol in table.iter_symbols()
        if symbol.name in wanted
        and symbol["st_shndx"] != "SHN_UNDEF"
        and symbol["st_info"]["bind"] in ("STB_GLOBAL", "STB_WEAK")
        and symbol["st_info"]["type"] in ("STT_NOTYPE", "STT_OBJECT")
    }
    missing = sorted(needed - by_name.keys())
    if missing:
        raise ProgramError(
            f"has no symbol {', '.join(missing[:3])}",
            where=path,
            expected="every object of the C header",
            do=f"compile bte_car_{data.prefix}.c, or define "
            f"{data.prefix.upper()}_DEFINE before a C header in one source file; "
            "keep what no code reads from the linker (KEEP in its script, or no --gc-sections)",
        )
    return by_name


def _check_same(path: Path, data: Dataset, constant: Object, elf: Any, symbol: Any) -> None:
    """Raise ProgramError where the program holds other numbers than the export."""
    values = constant.values.astype(np.float32) if data.single else constant.values
    if constant.fixed is not None:
        values = constant.fixed.raw.astype(f"i{constant.fixed.bits // 8}")
    kind = values.dtype.newbyteorder("<" if elf.little_endian else ">")
    size, in_program = symbol["st_size"], _bytes_of(path, elf, symbol)
    if constant.within is not None and in_program is not None:
        size, in_program = values.nbytes, in_program[constant.within.offset :][: values.nbytes]
    differs = in_program is not None and in_program != values.astype(kind).tobytes()
    if size != values.nbytes or differs:
        raise ProgramError(
            f"holds other numbers in {constant.label}, {size} bytes",
            where=path,
            expected=f"those of {data.stored.id}, {values.nbytes} bytes",
            do="export the version that the program holds, with --points, --fixed-point or --float "
            "of its C header, or build the program again",
        )
    if symbol["st_value"] > _LARGEST_ADDRESS:
        message = f"{constant.label} is at 0x{symbol['st_value']:X}"
        raise ProgramError(message, where=path, expected="addresses of 32 bits, as A2L has")


def _bytes_of(path: Path, elf: Any, symbol: Any) -> bytes | None:
    """Return the bytes of an object; None where the file does not hold them."""
    if not isinstance(symbol["st_shndx"], int):
        return None
    section = elf.get_section(symbol["st_shndx"])
    begin, size = symbol["st_value"] - section["sh_addr"], symbol["st_size"]
    if not 0 <= begin <= section["sh_size"] - size:
        raise ProgramError("is damaged: a symbol lies outside its section", where=path)
    if section["sh_type"] != "SHT_PROGBITS":
        return None
    return bytes(section.data()[begin : begin + size])

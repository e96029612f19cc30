"""Symbols of a map file of GNU ld (``-Wl,-Map=FILE``).

     .rodata.car_f1
                    0x0000000008001200       0x80 table.o
                    0x0000000008001200                car_f1       <- the line that is read

Lines of sections, of assignments and of PROVIDE have more than an address and a name.
"""

import re
from collections.abc import Collection
from pathlib import Path

from calib.errors import ProgramError
from calib.exports.memory import EcuSymbols, Symbol

LINE = re.compile(rb"^[ \t]{1,40}0x([0-9a-fA-F]{1,16})[ \t]{1,40}([A-Za-z_]\w*)\r?$", re.MULTILINE)

REMARK = (
    "a map file has no byte order, no sizes and no content: little endian is assumed, and "
    "whether the program holds this table is not checked; an ELF file tells"
)


def read_map(path: Path, data: bytes, wanted: Collection[str]) -> EcuSymbols:
    """The ``wanted`` symbols of a map file.

    Raises ProgramError for a file without lines of symbols, or a symbol with two addresses.
    """
    names = {name.encode(): name for name in wanted}
    found: dict[str, Symbol] = {}
    lines = 0
    for line in LINE.finditer(data):
        lines += 1
        if line[2] not in names:
            continue
        name, at = names[line[2]], Symbol(int(line[1], 16))
        if found.setdefault(name, at) != at:
            raise ProgramError(
                f"{name} is at 0x{found[name].address:X} and at 0x{at.address:X}",
                where=path,
                expected="one address for each symbol",
                do="give the ELF file",
            )
    if not lines:
        raise ProgramError(
            "has no line of a symbol",
            where=path,
            expected="an ELF file, or a map file of GNU ld (-Wl,-Map=FILE)",
        )
    return EcuSymbols(found, None, (REMARK,))

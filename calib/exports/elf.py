"""Symbol table of an ELF file, by the System V ABI (gABI 4.1): 32 and 64 bits, both byte orders.

    header ──> section headers ──> SYMTAB ──> symbol: name (in STRTAB), value, size, section
                                                         └──> PROGBITS: its bytes in the file

Only the symbol table is read: no debug information is needed, and nothing is executed.
"""

import struct
from collections.abc import Collection, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple

from calib.errors import ProgramError
from calib.exports.memory import EcuSymbols, Symbol

MAGIC = b"\x7fELF"
RELOCATABLE, DYNAMIC = 1, 3
PROGBITS, SYMTAB = 1, 2
GLOBAL_OR_WEAK = (1, 2)
DATA = (0, 1)
"""Types of symbols of data: not told, object."""

MOST_CONTENT = 1 << 16
"""Largest object whose bytes are read [byte]."""


class _Section(NamedTuple):
    kind: int
    address: int
    offset: int
    size: int
    link: int


class _Entry(NamedTuple):
    name: int
    info: int
    section: int
    value: int
    size: int


@dataclass(frozen=True)
class _File:
    """The bytes of an ELF file of ``path``; ``order`` of bytes in the words of `struct`."""

    path: Path
    data: bytes
    order: str
    wide: bool

    def part(self, offset: int, size: int) -> bytes:
        """Bytes of the file. Raises ProgramError where it ends before them."""
        if offset + size > len(self.data):
            raise ProgramError(
                f"is cut off: it has {len(self.data)} bytes and names {offset + size}",
                where=self.path,
                do="copy or link it again",
            )
        return self.data[offset : offset + size]

    def unpack(self, words: str, offset: int) -> tuple[int, ...]:
        """Integers at ``offset``."""
        form = self.order + words
        return struct.unpack(form, self.part(offset, struct.calcsize(form)))


def read_elf(path: Path, data: bytes, wanted: Collection[str]) -> EcuSymbols:
    """The ``wanted`` global symbols of an ELF file, with their bytes where the file holds them.

    Raises ProgramError for a file that is cut off, damaged, not linked or without symbol table.
    """
    file = _opened(path, data)
    kind = file.unpack("H", 16)[0]
    if kind == RELOCATABLE:
        raise ProgramError(
            "is an object file, whose addresses are not fixed yet",
            where=path,
            expected="the linked program",
        )
    sections = _sections(file)
    tables = [section for section in sections if section.kind == SYMTAB]
    if not tables:
        raise ProgramError(
            "has no symbol table",
            where=path,
            expected="the program as the linker wrote it",
            do="take the file from before `strip`, or give the linker's map file",
        )
    names = {name.encode(): name for name in wanted}
    found = {
        names[name]: _symbol(file, sections, entry)
        for table in tables
        for name, entry in _entries(file, sections, table, names)
    }
    moved = "it is position-independent: its addresses count from where it is loaded"
    return EcuSymbols(found, file.order == ">", (moved,) if kind == DYNAMIC else ())


def _opened(path: Path, data: bytes) -> _File:
    width, order = (*data[4:6], 0, 0)[:2]
    if width not in (1, 2) or order not in (1, 2):
        raise ProgramError(
            f"is damaged: ELF of class {width} and byte order {order}",
            where=path,
            expected="1 or 2 for each",
        )
    return _File(path, data, "<" if order == 1 else ">", width == 2)


def _sections(file: _File) -> list[_Section]:
    at, size, count = (
        (file.unpack("Q", 40)[0], *file.unpack("HH", 58))
        if file.wide
        else (file.unpack("I", 32)[0], *file.unpack("HH", 46))
    )
    words, rest = ("IIQQQQI", "IQQ") if file.wide else ("IIIIIII", "III")
    if at == 0:
        return []
    if size != struct.calcsize("=" + words) + struct.calcsize("=" + rest):
        raise ProgramError(f"is damaged: section headers of {size} bytes", where=file.path)
    if count == 0:  # more than 65279 sections: the first one's size is their number
        count = file.unpack(words, at)[5]
    file.part(at, count * size)
    rows = (file.unpack(words, at + i * size) for i in range(count))
    return [_Section(kind, *where) for _, kind, _, *where in rows]


def _entries(
    file: _File, sections: list[_Section], table: _Section, names: Collection[bytes]
) -> Iterator[tuple[bytes, _Entry]]:
    """Symbols of these names that are global, defined, and data."""
    if table.link >= len(sections):
        raise ProgramError("is damaged: its symbols have no names", where=file.path)
    strings = sections[table.link]
    text = file.part(strings.offset, strings.size)
    longest = max(map(len, names), default=0)
    form = struct.Struct(file.order + ("IBBHQQ" if file.wide else "IIIBBH"))
    rows = file.part(table.offset, table.size - table.size % form.size)
    for row in form.iter_unpack(rows):
        if file.wide:
            entry = _Entry(row[0], row[1], *row[3:])
        else:
            entry = _Entry(row[0], row[3], row[5], row[1], row[2])
        if (
            entry.section == 0
            or entry.info >> 4 not in GLOBAL_OR_WEAK
            or entry.info & 15 not in DATA
        ):
            continue
        name, end, _ = text[entry.name : entry.name + longest + 1].partition(b"\0")
        if end and name in names:
            yield name, entry


def _symbol(file: _File, sections: list[_Section], entry: _Entry) -> Symbol:
    """A symbol, with its bytes where its section has them in the file."""
    content = None
    if entry.section < len(sections) and entry.size <= MOST_CONTENT:
        home = sections[entry.section]
        if not 0 <= entry.value - home.address <= home.size - entry.size:
            raise ProgramError("is damaged: a symbol lies outside its section", where=file.path)
        if home.kind == PROGBITS:
            content = file.part(home.offset + entry.value - home.address, entry.size)
    return Symbol(entry.value, entry.size, content)

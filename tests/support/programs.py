"""Linked programs that hold an exported C header: made by gcc, or by hand from the gABI."""

import re
import shutil
import struct
import subprocess

import pytest

GCC = shutil.which("gcc")
OBJDUMP = shutil.which("objdump")


def needs(*tools):
    """Leaves a test out where a tool is missing."""
    missing = [tool for tool in tools if shutil.which(tool) is None]
    return pytest.mark.skipif(bool(missing), reason=f"missing here: {', '.join(missing)}")


needs_gcc = needs("gcc", "objdump")

LINK = ["-no-pie", "-nostdlib", "-Wl,-e,main"]


def linked(folder, header, prefix, *options):
    """A program that defines the objects of a header, with debug information."""
    (folder / "table.h").write_bytes(header)
    (folder / "table.c").write_text(f'#define {prefix.upper()}_DEFINE\n#include "table.h"\n')
    (folder / "main.c").write_text('#include "table.h"\nint main(void) { return 0; }\n')
    out = folder / "ecu.elf"
    subprocess.run(
        [GCC, "-g", "-ffreestanding", *(options or LINK),
         folder / "table.c", *([] if "-c" in options else [folder / "main.c"]), "-o", out],
        check=True,
    )  # fmt: skip
    return out


def memory_of(elf):
    """Function that gives the bytes of a program at an address, as objdump prints them."""
    printed = subprocess.run(
        [OBJDUMP, "-s", elf], capture_output=True, text=True, check=True
    ).stdout
    contents = {}
    for line in re.findall(r"^ ([0-9a-f]{4,}) ((?:[0-9a-f]{2,8} ){1,4})", printed, re.MULTILINE):
        for i, byte in enumerate(bytes.fromhex(line[1].replace(" ", ""))):
            contents.setdefault(int(line[0], 16) + i, byte)
    return lambda at, size: bytes(contents[at + i] for i in range(size))


def made_elf(objects, order, wide, base=0x1000, home=None):
    """ELF of one section of data at ``base`` that holds ``objects``, bytes by name.

    ``order`` < or >; ``wide`` 64 bits; ``home`` address of the section if it is another one.
    """
    word = "Q" if wide else "I"
    head = 64 if wide else 52
    names, symbols, data = (
        b"\0",
        struct.pack(f"{order}{'IBBHQQ' if wide else 'IIIBBH'}", *6 * [0]),
        b"",
    )
    for name, content in objects.items():
        address, size = base + len(data), len(content)
        row = (
            ("IBBHQQ", len(names), 0x11, 0, 1, address, size)
            if wide
            else ("IIIBBH", len(names), address, size, 0x11, 0, 1)
        )
        symbols += struct.pack(order + row[0], *row[1:])
        names, data = names + name.encode() + b"\0", data + content
    where = [head, head + len(data), head + len(data) + len(symbols)]
    sections = [
        (0, 0, 0, 0, 0, 0, 0, 0, 0, 0),
        (0, 1, 2, base if home is None else home, where[0], len(data), 0, 0, 1, 0),
        (0, 2, 0, 0, where[1], len(symbols), 3, 1, 8, 24 if wide else 16),
        (0, 3, 0, 0, where[2], len(names), 0, 0, 1, 0),
    ]
    rows = b"".join(struct.pack(f"{order}II{4 * word}II{2 * word}", *s) for s in sections)
    ident = b"\x7fELF" + bytes([1 + wide, 1 + (order == ">"), 1]) + bytes(9)
    table = where[2] + len(names)
    return (
        ident
        + struct.pack(f"{order}HHI{3 * word}IHHHHHH", 2, 0, 1, 0, 0, table, 0, head, 0, 0,
                      64 if wide else 40, len(sections), 0)
        + data + symbols + names + rows
    )  # fmt: skip

"""Addresses in programs made by gcc, or by hand in the other byte order and width."""

import random
import shutil
import struct
import subprocess
from dataclasses import replace

import pytest

from calib.base.bounded import PROGRAM
from calib.base.errors import ProgramError
from calib.exports.addresses import find_addresses
from calib.exports.build import build
from calib.exports.write import FORMATS
from tests.support.a2l import decoded, read_a2l
from tests.support.programs import linked, made_elf, needs_gcc
from tests.support.refusals import refusal
from tests.support.tables import made_table


@pytest.fixture
def data(stored):
    return build(stored, 5)


def bytes_by_label(data, order):
    """Return the bytes of each object in double, by label."""
    return {o.label: struct.pack(f"{order}{len(o.values)}d", *o.values) for o in data.objects}


@pytest.fixture
def program(tmp_path):
    """Return a function that writes a file with the words content."""

    def write(content):
        path = tmp_path / "ecu"
        path.write_bytes(content)
        return path

    return write


@pytest.mark.parametrize("order", ["<", ">"])
@pytest.mark.parametrize("wide", [False, True])
def test_both_byte_orders_and_both_widths_of_elf(data, program, order, wide):
    objects, base = bytes_by_label(data, order), 0x8000_0000
    elf = made_elf(objects, order, wide, base=base)
    if readelf := shutil.which("readelf"):
        run = subprocess.run([readelf, "-Ws", program(elf)], capture_output=True, text=True)
        assert (run.stderr, data.scalars[0].label in run.stdout) == ("", True)
    addresses = find_addresses(program(elf), data)
    assert (addresses.big_endian, addresses.remarks) == (order == ">", ())
    memory = b"".join(objects.values())
    module = read_a2l(FORMATS["a2l"].write(replace(data, addresses=addresses))).only("MODULE")
    numbers = decoded(module, lambda a, size: memory[a - base : a - base + size])
    assert numbers["sedan_f1"] == data.curves[0].values.tolist()
    assert numbers["sedan_mass"] == [1744.0]


@needs_gcc
def test_an_object_file_a_stripped_program_and_a_moving_one(data, tmp_path):
    elf = linked(tmp_path, FORMATS["c-header"].write(data), data.prefix, "-c")
    refusal(find_addresses, elf, data, kind=ProgramError, names=elf)
    elf = linked(tmp_path, FORMATS["c-header"].write(data), data.prefix)
    subprocess.run(["strip", elf], check=True)
    refusal(find_addresses, elf, data, kind=ProgramError, names=elf)
    options = ("-pie", "-fPIE", "-nostdlib", "-Wl,-e,main")
    elf = linked(tmp_path, FORMATS["c-header"].write(data), data.prefix, *options)
    assert "from where it is loaded" in find_addresses(elf, data).remarks[0]


def test_a_program_of_other_numbers_is_refused(stored, data, program):
    elf = program(made_elf(bytes_by_label(data, "<"), "<", True))
    refusal(find_addresses, elf, build(stored, 5, bits=16), kind=ProgramError, names="sedan_eta")
    other = build(replace(stored, table=made_table(28.0)), 5)
    refusal(find_addresses, elf, other, kind=ProgramError, names="sedan@1")


def test_symbols_that_are_missing_outside_their_section_or_too_far_are_refused(data, program):
    objects = bytes_by_label(data, "<")
    del objects["sedan_f2"], objects["sedan_D"]
    says = refusal(find_addresses, program(made_elf(objects, "<", False)), data, names="sedan_D")
    assert "SEDAN_DEFINE" in says
    whole = bytes_by_label(data, "<")
    far = program(made_elf(whole, "<", True, base=0x1_0000_0000))
    assert "32 bits" in refusal(find_addresses, far, data, names="0x100000000")
    for home in (0x0FF8, 0x1008):
        elf = program(made_elf(whole, "<", True, base=0x1000, home=home))
        refusal(find_addresses, elf, data, kind=ProgramError)


@pytest.mark.parametrize(
    ("content", "says"),
    [
        (b"", "is no ELF file"),
        (b" 0x00001000    sedan_f1\n", "expected the linked program, and no map file"),
        (b"\x7fELF", "is damaged"),
        (b"\x7fELF\x02\x01" + bytes(4), "is damaged"),
    ],
)
def test_files_of_another_kind(data, program, content, says):
    assert says in refusal(find_addresses, program(content), data, kind=ProgramError)


def test_no_file_a_folder_and_a_file_too_large(data, tmp_path):
    large = tmp_path / "large"
    with large.open("wb") as file:
        file.truncate(PROGRAM.max_bytes + 1)
    for path in (tmp_path / "none", tmp_path, large):
        refusal(find_addresses, path, data, kind=ProgramError)


@pytest.mark.parametrize(("order", "wide"), [("<", True), (">", False)])
def test_a_damaged_program_is_read_rightly_or_refused(data, program, order, wide):
    """Many cuts, and 300 changes of one byte of the header, symbols and sections."""
    whole = made_elf(bytes_by_label(data, order), order, wide)
    expected = find_addresses(program(whole), data).by_label
    for end in range(4, len(whole), 41):
        refusal(find_addresses, program(whole[:end]), data, kind=ProgramError)
    draw, refused = random.Random(1), 0
    for _ in range(300):
        place = draw.choice([*range(4, 64), *range(len(whole) - 1500, len(whole))])
        broken = whole[:place] + bytes([draw.randrange(256)]) + whole[place + 1 :]
        try:
            addresses = find_addresses(program(broken), data).by_label
        except ProgramError:
            refused += 1
        else:
            assert addresses.keys() == expected.keys()
    assert refused > 30

"""A2L as a2ltool sees it (MIT or Apache 2.0), and decoded from the bytes of a program.

The memory is that of a program that gcc made of the C header of the same export.
"""

import re
import shutil
import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from calib.base.errors import ExchangeError
from calib.exports.addresses import find_addresses
from calib.exports.symbols import Addresses
from calib.exports.write import FORMATS
from tests.support.a2l import decoded, objects, read_a2l
from tests.support.curves import built
from tests.support.programs import linked, memory_of, needs_gcc
from tests.support.refusals import refusal
from tests.support.tables import made_table

WIDTHS = [None, 16]
A2LTOOL = shutil.which("a2ltool", path=Path(sys.executable).parent) or shutil.which("a2ltool")

needs_a2ltool = pytest.mark.skipif(A2LTOOL is None, reason="no a2ltool here (pip install a2ltool)")


def a2ltool(folder, content, *options):
    """The file as a2ltool writes it again, without comments; in strict mode it has no complaint."""
    (folder / "in.a2l").write_bytes(content)
    out = folder / "out.a2l"
    run = subprocess.run(
        [A2LTOOL, "--strict", "--check", folder / "in.a2l", *options, "-o", out],
        capture_output=True, text=True, timeout=60,
    )  # fmt: skip
    assert run.returncode == 0, run.stdout + run.stderr
    assert "No problems found" in run.stdout
    return re.sub(r"/\*.*?\*/", "", out.read_text(), flags=re.DOTALL)


@needs_gcc
@pytest.mark.parametrize("bits", WIDTHS)
def test_bytes_at_the_addresses_decode_to_the_table(real, tmp_path, bits):
    data = built(real, 8, bits=bits)
    elf = linked(tmp_path, FORMATS["c-header"].write(data), data.prefix)
    module = read_a2l(
        FORMATS["a2l"].write(replace(data, addresses=find_addresses(elf, data)))
    ).only("MODULE")
    numbers = decoded(module, memory_of(elf))
    truth = {constant.label: constant.values for constant in data.objects}
    assert numbers.keys() == truth.keys()
    for name, values in truth.items():
        if bits is None:
            assert [v.hex() for v in numbers[name]] == [float(v).hex() for v in values]
        else:
            largest = np.abs(values - (1.0 if "eta" in name else 0.0)).max()
            step = 2.0 * largest / (2 ** (bits - 1) - 1)
            assert np.abs(np.array(numbers[name]) - values).max() <= step / 2 + 1e-15


@pytest.mark.parametrize("bits", WIDTHS)
def test_limits_hold_the_numbers_and_the_type_holds_the_limits(real, bits):
    data = built(real, 8, bits=bits)
    module = read_a2l(FORMATS["a2l"].write(data)).only("MODULE")
    by_label = objects(module)
    for curve in data.curves:
        low, high = by_label[curve.label][3]
        assert low <= curve.values.min() < curve.values.max() <= high
    mu = next(s for s in data.scalars if s.label.endswith("_mu_f"))
    low, high = by_label[mu.label][3]
    assert low <= mu.values[0] <= high
    for block in module.all("AXIS_PTS", "CHARACTERISTIC"):
        least, most = map(float, block.after("EXTENDED_LIMITS", 2))
        low, high = by_label[block.words[0]][3]
        assert least <= low <= high <= most


def test_addresses_and_the_order_of_bytes_are_those_of_the_program(stored):
    project = read_a2l(FORMATS["a2l"].write(built(stored)))
    assert project.words == ["sedan", '"sedan@1"']
    placed = Addresses({"sedan_f1": 0x80001234}, big_endian=True, remarks=())
    text = FORMATS["a2l"].write(replace(built(stored), addresses=placed)).decode()
    assert "all addresses" not in text
    assert "CURVE 0x80001234 " in text
    assert "BYTE_ORDER MSB_FIRST" in text


@pytest.mark.parametrize("name", ['2 Räder */ /* ??/ \\ // "車', "/begin PROJECT", "\x1b]0;x\x07"])
def test_a_name_full_of_traps_is_read(stored, tmp_path, name):
    data = built(replace(stored, name=name, table=made_table(name=name)))
    content = FORMATS["a2l"].write(data)
    assert read_a2l(content).words[0] == data.prefix
    assert b"\x1b" not in content
    if A2LTOOL:
        assert data.prefix in a2ltool(tmp_path, content)


def test_a_name_too_long_for_a_text_is_refused(stored):
    data = built(replace(stored, name="a" * 200))
    message = refusal(FORMATS["a2l"].write, data, kind=ExchangeError, names="aaaa")
    assert "at most 255" in message

"""The header as a C compiler sees it: no warning, and every number printed by the program."""

import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from calib.car.effects.effects import Effects
from calib.exports.build import build
from calib.exports.c_header import write_c_header
from calib.exports.dataset import LONGEST
from tests.support.tables import made_table

COMPILER = shutil.which("gcc") or shutil.which("cc") or shutil.which("clang")
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-Wconversion", "-Wshadow"]

needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C compiler (gcc, cc, clang) here")


def compiled(folder, header, first, body):
    """Output of a program of two files that both include the header; one defines its objects."""
    (folder / "table.h").write_bytes(header)
    (folder / "table.c").write_text(f'#define {first.upper()}_DEFINE\n#include "table.h"\n')
    (folder / "main.c").write_text(
        '#include <stdio.h>\n#include "table.h"\n#include "table.h"\n'
        f"int main(void) {{\n{body}\nreturn 0;\n}}\n"
    )
    sources = [str(folder / "table.c"), str(folder / "main.c")]
    run = subprocess.run(
        [COMPILER, *STRICT, *sources, "-o", str(folder / "show")], capture_output=True, text=True
    )
    assert run.returncode == 0, run.stderr
    return subprocess.run([folder / "show"], capture_output=True, text=True, check=True).stdout


def shown(data, fixed):
    """C code that prints every number of the header, in double or as its integers stand for."""
    value = "{0}_origin + {0}_step * (double){0}{1}" if fixed else "{0}{1}"
    lines = [f'printf("{data.prefix}_id %s\\n", {data.prefix}_id);']
    lines += [f'printf("{data.prefix}_digest %s\\n", {data.prefix}_digest);']
    arrays = [(a.label, a.label) for a in data.axes] + [(c.label, c.axis) for c in data.curves]
    for name, axis in arrays:
        loop = f"for (unsigned i = 0U; i < {axis.upper()}_SIZE; i++)"
        lines.append(f'{loop} {{ printf("{name} %.17g\\n", {value.format(name, "[i]")}); }}')
    lines += [f'printf("{s.label} %.17g\\n", {value.format(s.label, "")});' for s in data.scalars]
    return "\n".join(lines)


def printed(output):
    found = {}
    for line in output.splitlines():
        name, value = line.split(" ", 1)
        found.setdefault(name, []).append(value)
    return found


@needs_compiler
@pytest.mark.parametrize("points", [None, 16])
def test_a_compiler_sees_the_table_to_the_last_bit(real, truth, tmp_path, points):
    data = build(real, points)
    first = data.prefix
    seen = printed(compiled(tmp_path, write_c_header(data), first, shown(data, fixed=False)))
    assert (seen[f"{first}_id"], seen[f"{first}_digest"]) == ([real.id], [real.digest])
    texts = {f"{first}_id", f"{first}_digest"}
    number = {n: [float(v) for v in values] for n, values in seen.items() if n not in texts}
    for name, axis in (("f1", "eta"), ("f2", "eta"), ("D", "eta"), ("g", "slip")):
        x, y = number[f"{first}_{axis}"], number[f"{first}_{name}"]
        pairs = [(a.hex(), b.hex()) for a, b in zip(x, y, strict=True)]
        assert pairs == truth(real).at(x)[name]
    assert number[f"{first}_mass"] == [real.table.vehicle.mass]


@needs_compiler
@pytest.mark.parametrize("bits", [8, 16, 32])
def test_fixed_point_errs_by_what_it_says(real, tmp_path, bits):
    data = build(real, 8)
    header = write_c_header(data, bits)
    seen = printed(compiled(tmp_path, header, data.prefix, shown(data, fixed=True)))
    text = header.decode()
    for name, values in [(c.label, c.values) for c in (*data.axes, *data.curves)]:
        says = re.search(rf"error at most (\S+) \*/\nextern const int{bits}_t {name}\[", text)
        error = np.abs(np.array(list(map(float, seen[name]))) - values).max()
        assert error <= float(says[1]) * 1.01 + 1e-17
    eta = [float(v) for v in seen[f"{data.prefix}_eta"]]
    assert np.all(np.diff(eta) > 0)


@needs_compiler
def test_a_name_full_of_traps_compiles(stored, tmp_path):
    from dataclasses import replace

    name = '2 Räder */ /* ??/ \\ // "車'
    odd = replace(stored, name=name, table=made_table(name=name))
    data = build(odd)
    body = f'for (const char *c = {data.prefix}_id; *c != 0; c++) {{ printf("%02x", *c & 0xff); }}'
    output = compiled(tmp_path, write_c_header(data), data.prefix, body)
    assert bytes.fromhex(output).decode() == f"{name}@1"


@pytest.mark.parametrize("bits", [None, 16])
def test_names_differ_within_31_characters(stored, bits):
    """As C99 and MISRA C:2012 (5.1) want it of external names, for long names of effects too."""
    parameters = {"pad_pressure_dependence": {"exponent": 0.1, "excess": 1.0}}
    sigma = {"pad_pressure_dependence": {"exponent": 0.01, "excess": 0.1}}
    name = "a vehicle with a very long name"
    table = replace(made_table(name=name), effects=Effects(parameters, sigma=sigma))
    text = write_c_header(build(replace(stored, name=name, table=table)), bits).decode()
    labels = re.findall(r"extern const \w+ (\w+)", text)
    assert len(labels) > 20
    assert len({label[:LONGEST] for label in labels}) == len(labels)


def test_the_head_says_what_it_is(stored):
    text = write_c_header(build(stored, 5), 16).decode()
    for part in ("table: sedan@1", stored.digest, "clamped", "5 of 21 rows", "int16_t"):
        assert part in text

"""The header as a C compiler sees it: no warning, and every number printed by the program."""

import re
import shutil
import subprocess
from dataclasses import replace

import numpy as np
import pytest

from calib.exports.build import build
from calib.exports.write import FORMATS
from tests.support.curves import built
from tests.support.tables import made_table

COMPILER = shutil.which("gcc") or shutil.which("cc") or shutil.which("clang")
STRICT = ["-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic", "-Wconversion", "-Wshadow"]

needs_compiler = pytest.mark.skipif(COMPILER is None, reason="no C compiler (gcc, cc, clang) here")


def printed(folder, data, body):
    """Output of a program of two files that both include the header; one defines its objects."""
    (folder / "table.h").write_bytes(FORMATS["c-header"].write(data))
    (folder / "table.c").write_text(f'#define {data.prefix.upper()}_DEFINE\n#include "table.h"\n')
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


def shown(data):
    """Return C code that prints every number of the header; in fixed point the decoded number."""
    value = "{0}_origin + {0}_step * (double){1}" if data.bits else "{1}"
    lines = []
    for constant in data.objects:
        first_cell = "[0]" * len(constant.axes) or ("[0]" if constant in data.axes else "")
        number = value.format(constant.label, f"(&{constant.label}{first_cell})[i]")
        text = f'printf("{constant.label} %.17g\\n", {number});'
        lines.append(f"for (unsigned i = 0U; i < {len(constant.values)}U; i++) {{ {text} }}")
    return "\n".join(lines)


@needs_compiler
@pytest.mark.parametrize(("points", "width"), [(None, None), (8, 8), (8, 16), (8, 32)])
def test_a_compiler_sees_the_table(real, tmp_path, points, width):
    """Equal to the last bit in double; in fixed point within the error in the comment."""
    data, by_label = build(real, points, bits=width), {}
    for line in printed(tmp_path, data, shown(data)).splitlines():
        by_label.setdefault(line.split()[0], []).append(float(line.split()[1]))
    text = FORMATS["c-header"].write(data).decode()
    assert "_ */" not in text  # a line break in a comment would become an underscore
    assert by_label.keys() == {constant.label for constant in data.objects}
    for constant in data.objects:
        error = np.abs(np.array(by_label[constant.label]) - constant.values).max()
        if width is None:
            expected = [v.hex() for v in constant.numbers]
            assert [v.hex() for v in by_label[constant.label]] == expected
        else:
            comment = re.search(
                rf"at most (\S+) \*/\nextern const int(?:{width}|16)_t {constant.label}\b", text
            )
            assert error <= float(comment[1]) * 1.01 + 1e-17
    assert np.all(np.diff(by_label[f"{data.prefix}_eta"]) > 0)


@needs_compiler
def test_a_name_full_of_traps_compiles(stored, tmp_path):
    name = '2 Räder */ /* ??/ \\ // "車'
    data = built(replace(stored, name=name, table=made_table(name=name)))
    body = f'for (const char *c = {data.prefix}_id; *c != 0; c++) {{ printf("%02x", *c & 0xff); }}'
    assert bytes.fromhex(printed(tmp_path, data, body)).decode() == f"{name}@1"

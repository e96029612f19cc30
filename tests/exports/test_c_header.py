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
    """C code that prints every number of the header, as its integers stand for in fixed point."""
    value = "{0}_origin + {0}_step * (double){1}" if data.bits else "{1}"
    lines = []
    for one in data.objects:
        first = "[0]" * len(one.axes) or ("[0]" if one in data.axes else "")
        at = value.format(one.label, f"(&{one.label}{first})[i]")
        text = f'printf("{one.label} %.17g\\n", {at});'
        lines.append(f"for (unsigned i = 0U; i < {len(one.values)}U; i++) {{ {text} }}")
    return "\n".join(lines)


@needs_compiler
@pytest.mark.parametrize(("points", "width"), [(None, None), (8, 8), (8, 16), (8, 32)])
def test_a_compiler_sees_the_table(real, tmp_path, points, width):
    """To the last bit in double; in fixed point it errs by what the comment says."""
    data, seen = build(real, points, bits=width), {}
    for line in printed(tmp_path, data, shown(data)).splitlines():
        seen.setdefault(line.split()[0], []).append(float(line.split()[1]))
    text = FORMATS["c-header"].write(data).decode()
    assert seen.keys() == {one.label for one in data.objects}
    for one in data.objects:
        error = np.abs(np.array(seen[one.label]) - one.values).max()
        if width is None:
            assert [v.hex() for v in seen[one.label]] == [v.hex() for v in one.numbers]
        else:
            says = re.search(
                rf"at most (\S+) \*/\nextern const int(?:{width}|16)_t {one.label}\b", text
            )
            assert error <= float(says[1]) * 1.01 + 1e-17
    assert np.all(np.diff(seen[f"{data.prefix}_eta"]) > 0)


@needs_compiler
def test_a_name_full_of_traps_compiles(stored, tmp_path):
    name = '2 Räder */ /* ??/ \\ // "車'
    data = built(replace(stored, name=name, table=made_table(name=name)))
    body = f'for (const char *c = {data.prefix}_id; *c != 0; c++) {{ printf("%02x", *c & 0xff); }}'
    assert bytes.fromhex(printed(tmp_path, data, body)).decode() == f"{name}@1"

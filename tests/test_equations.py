"""Every numbered equation of the paper has its number beside a line of the code."""

import ast
import io
import re
import tokenize
from pathlib import Path

import pytest

CALIB = Path(__file__).parents[1] / "calib"
CITED = re.compile(r"(?<![\w\])])\((\d{1,2})\)")
DOCUMENTED = (ast.Module, ast.ClassDef, ast.FunctionDef)


def prose(file: Path) -> list[str]:
    """Comments and docstrings of a file, and nothing that is code."""
    text = file.read_text()
    tokens = tokenize.generate_tokens(io.StringIO(text).readline)
    comments = [t.string for t in tokens if t.type == tokenize.COMMENT]
    nodes = [n for n in ast.walk(ast.parse(text)) if isinstance(n, DOCUMENTED)]
    return comments + [ast.get_docstring(n) or "" for n in nodes]


WHERE: dict[int, set[str]] = {}
for path in CALIB.rglob("*.py"):
    for number in CITED.findall("\n".join(prose(path))):
        WHERE.setdefault(int(number), set()).add(path.stem)

COMPUTED = dict.fromkeys((*range(1, 15), *range(17, 23)), "forces")
COMPUTED |= dict.fromkeys((15, 16), "tyre") | dict.fromkeys(range(23, 29), "adaptive")


@pytest.mark.parametrize("number", range(1, 29))
def test_equation_is_named_where_it_is_computed(number):
    assert COMPUTED[number] in WHERE.get(number, set())


def test_no_equation_is_named_that_the_paper_does_not_have():
    assert set(WHERE) <= set(range(1, 29))


@pytest.mark.parametrize("file", ["forces", "tyre", "adaptive"])
def test_the_numbers_stand_beside_lines(file):
    """Each in a comment on a line of code or above one, not only in the words above."""
    comments = [p for p in prose(CALIB / f"{file}.py") if p.startswith("#")]
    beside = {int(n) for n in CITED.findall("\n".join(comments))}
    assert {n for n, where in COMPUTED.items() if where == file} <= beside

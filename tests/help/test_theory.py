"""The pages on the theory and the step: equations that GitHub draws, and numbers of the program."""

import math
import re

import pytest
from matplotlib.mathtext import MathTextParser

from calib.help.page import FOLDER
from tests.support.theory import BLOCKS, PICTURES, SHEETS, block, constants, coverage

PAGES = {name: (FOLDER / f"{name}.md").read_text() for name in ("theory", "step")}
NUMBER = re.compile(r"-?\d+(?:\.\d+)?(?:e-\d+)?")


def test_every_constant_of_the_step_has_its_place_in_the_text():
    names = [half.split()[0] for line in constants() for half in (line[:40], line[40:]) if half]
    equations = PAGES["step"].partition("## Constants")[0]
    assert [x for x in names if f"`{x}`" not in equations] == []


@pytest.mark.parametrize("heading", BLOCKS)
def test_the_numbers_of_the_page_are_those_of_the_program(heading):
    printed, computed = block(heading), "\n".join(BLOCKS[heading]())
    assert NUMBER.sub("", printed).split() == NUMBER.sub("", computed).split()
    numbers = ([float(x) for x in NUMBER.findall(text)] for text in (printed, computed))
    assert next(numbers) == pytest.approx(next(numbers), rel=0.01, abs=0.003)


def test_the_stop_is_the_arithmetic_of_the_equations_beside_it():
    """(S14) to (S16) in the printed numbers; the file's pads are 0.4."""
    lines = block("A stop, step by step").splitlines()
    rows = dict(re.split(" {2,}", line, maxsplit=1) for line in lines)
    numbers = {name: [float(x) for x in NUMBER.findall(row)] for name, row in rows.items()}
    level, ratio = numbers["level, (S13)"][0], numbers["ratio, (S12)"][0]
    _, share, *_, n = numbers["n, (S14)"]
    assert n == pytest.approx(1.0 + share * math.expm1(ratio), abs=1e-3)
    bar, *gains = (float(x) for x in re.findall(r"[\d.]+(?= bar| m\^3)", rows["p; C_f, C_r"]))
    torques = numbers["torque of a wheel [N m]"][::3]
    for torque, gain, axle_ratio in zip(torques, gains, (ratio, 0.0), strict=True):
        friction = 0.4 * math.exp(level + axle_ratio) / n
        assert torque == pytest.approx(friction * gain * bar * 1e5, rel=3e-3)


@pytest.mark.parametrize("name", PAGES)
def test_equations_are_as_github_draws_them(name):
    """Markdown takes away a backslash before all but letters, and joins lines."""
    equations = re.findall(r"(?<=\n\n)\$\$\n(.+)\n\$\$(?=\n\n)", PAGES[name])
    assert len(equations) == PAGES[name].count("$$") // 2 > 10
    for equation in equations:
        assert not re.search(r"\\[^A-Za-z ]", equation)
        MathTextParser("path").parse(f"${re.sub(r'.tag.*', '', equation)}$")


def test_the_coverage_is_that_of_the_study():
    for name, share, _ in coverage():
        if name != "torque":
            key = {"ratio": "pad ratio"}.get(name, name)
            (row,) = re.findall(rf"^\| {key}[ ,].*$", PAGES["theory"], re.MULTILINE)
            assert [float(x) for x in re.findall(r"\b\d\.\d\d\b", row)] == share


def test_every_picture_is_on_the_page():
    pictures = {path.stem for path in PICTURES.iterdir()}
    assert pictures == set(re.findall(r"theory/(\w+)\.png", PAGES["theory"]))
    assert len(pictures) == len(SHEETS)

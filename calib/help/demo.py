"""The demo: command lines on the sample logs, and the index of their answers, pages and pictures.

`demo.csv` has the lines; a line uses what earlier lines wrote. The answers can be checked, since
the true torques and causes of the sample logs are known.
"""

import base64
import io
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from calib.base.plain import counted, rows
from calib.show.facts import FAILED, PASSED, WORDS, Facts, Table

INDEX = "index.html"
_THUMBNAIL, _SHADES = 160, 15
"""Approximate width of a picture in the index [px]; number of shades of each colour, less 1."""


@dataclass(frozen=True)
class Step:
    """One command line of the demo.

    Attributes
    ----------
    figure : number of the paper's figure that the command draws, "" for none.
    leaves : path of the page or picture that the command writes, "" for none.
    expected : text that a right answer contains.
    """

    figure: str
    purpose: str
    leaves: str
    expected: str
    line: str


@dataclass(frozen=True)
class Ran:
    """The answer of a command, and whether it ended with 0 and the expected answer."""

    answer: str
    passed: bool


STEPS = tuple(Step(**row) for row in rows("demo.csv", "calib.help"))


def demo_facts(ran: Mapping[Step, Ran], folder: Path) -> Facts:
    """Return the index of the demo; paths in the steps are relative to its ``folder``."""
    passed = sum(answer.passed for answer in ran.values())
    verdict = PASSED if passed == len(ran) else FAILED
    figures = [step for step in ran if step.figure]
    figures.sort(key=lambda step: int(step.figure.split()[0]))  # "10 and 11" is sorted as 10
    return Facts(
        title="brake-cal demo",
        verdict=verdict,
        word=WORDS[verdict],
        headline=f"{passed} of {counted(len(ran), 'command')} gave what was expected",
        next="brake-cal manual",
        tables=[
            _table("What was done; each command can be typed again in this folder.",
                   {step.purpose: step for step in ran if not step.figure}, ran, folder),
            _table("The paper's figures, drawn with these cars.",
                   {f"Fig. {step.figure}: {step.purpose}": step for step in figures}, ran, folder),
        ],
    )  # fmt: skip


def _table(caption: str, steps: Mapping[str, Step], ran: Mapping[Step, Ran], folder: Path) -> Table:
    """Return a table of ``steps`` by their names, with links to what they wrote."""
    rows = [(name, step.line, ran[step].answer) for name, step in steps.items()]
    verdicts = [PASSED if ran[step].passed else FAILED for step in steps.values()]
    links = [step.leaves if ran[step].passed else "" for step in steps.values()]
    images = [_thumbnail(folder / link) if link.endswith(".png") else "" for link in links]
    return Table(("step", "command", "answer"), rows, caption, verdicts, links, images)


def _thumbnail(picture: Path) -> str:
    """Return a small copy of a picture as a data URI: means over squares of pixels."""
    from matplotlib.image import imread, imsave

    pixels, buffer = imread(picture), io.BytesIO()  # (height, width, colours)
    side = max(1, pixels.shape[1] // _THUMBNAIL)
    height, width = (size // side for size in pixels.shape[:2])
    squares = pixels[: height * side, : width * side, :3].reshape(height, side, width, side, 3)
    imsave(buffer, np.rint(_SHADES * squares.mean(axis=(1, 3))) / _SHADES, format="png")
    return f"data:image/png;base64,{base64.b64encode(buffer.getvalue()).decode()}"

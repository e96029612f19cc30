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


@dataclass(frozen=True)
class Step:
    """One command ``line`` of the demo."""

    figure: str  # number of the paper's figure that the command draws, "" for none
    purpose: str
    leaves: str  # path of the page or picture that the command writes, "" for none
    expected: str  # text that a right answer contains
    line: str


@dataclass(frozen=True)
class Ran:
    """The answer of a command, and whether exit code and answer were right."""

    answer: str
    passed: bool


STEPS = tuple(Step(**row) for row in rows("demo.csv", "calib.help"))


def demo_facts(ran: Mapping[Step, Ran], folder: Path) -> Facts:
    """Return the index of the demo; the paths of the steps are relative to its ``folder``."""
    passed = sum(answer.passed for answer in ran.values())
    verdict = PASSED if passed == len(ran) else FAILED
    commands = {step.purpose: step for step in ran if not step.figure}
    drawing = [step for step in ran if step.figure]
    drawing.sort(key=lambda step: int(step.figure.split()[0]))  # "10 and 11" is sorted as 10
    figures = {f"Fig. {step.figure}: {step.purpose}": step for step in drawing}
    of_commands = "What was done; each command can be typed again in this folder."
    return Facts(
        title="brake-cal demo",
        verdict=verdict,
        word=WORDS[verdict],
        headline=f"{passed} of {counted(len(ran), 'command')} gave what was expected",
        next="brake-cal manual",
        tables=[
            _table(of_commands, commands, ran, folder),
            _table("The paper's figures, drawn with these cars.", figures, ran, folder),
        ],
    )


def _table(caption: str, steps: Mapping[str, Step], ran: Mapping[Step, Ran], folder: Path) -> Table:
    """Return a table of ``steps`` by their names, with links to what they wrote."""
    rows, verdicts, links, images = [], [], [], []
    for name, step in steps.items():
        passed = ran[step].passed
        link = step.leaves if passed else ""
        rows.append((name, step.line, ran[step].answer))
        verdicts.append(PASSED if passed else FAILED)
        links.append(link)
        images.append(_thumbnail(folder / link) if link.endswith(".png") else "")
    return Table(("step", "command", "answer"), rows, caption, verdicts, links, images)


def _thumbnail(picture: Path) -> str:
    """Return a small copy of a picture as a data URI: means over squares of pixels."""
    from matplotlib.image import imread, imsave

    pixels, buffer = imread(picture), io.BytesIO()  # (height, width, colours) from 0 to 1
    side = max(1, pixels.shape[1] // 160)  # of a square [px]: about 160 squares in a row
    height, width = (size // side for size in pixels.shape[:2])  # in squares
    squares = pixels[: height * side, : width * side, :3].reshape(height, side, width, side, 3)
    colours = np.rint(15.0 * squares.mean(axis=(1, 3))) / 15.0  # in 15 steps, for a small file
    imsave(buffer, colours, format="png")
    return f"data:image/png;base64,{base64.b64encode(buffer.getvalue()).decode()}"

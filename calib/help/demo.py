"""The demo: command lines on the sample logs, and the index of what they answered and left.

A line needs what those before it made. Answers are known, since true torques and causes are.
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
"""Width of a picture in the index, about [px], and shades of each colour."""


@dataclass(frozen=True)
class Step:
    """One command line: its ``purpose``, the page or picture that it ``leaves``, "" for none.

    ``expected`` is in its answer if all is well; ``figure`` is what it draws of the paper.
    """

    figure: str
    purpose: str
    leaves: str
    expected: str
    line: str


@dataclass(frozen=True)
class Ran:
    """What a line answered, and whether it ended well with what was expected."""

    answer: str
    passed: bool


STEPS = tuple(Step(**row) for row in rows("demo.csv", "calib.help"))


def demo_facts(ran: Mapping[Step, Ran], folder: Path) -> Facts:
    """The index; its links lead from the ``folder`` of the demo."""
    passed = sum(one.passed for one in ran.values())
    verdict = PASSED if passed == len(ran) else FAILED
    drawn = sorted((s for s in ran if s.figure), key=lambda s: int(s.figure.split()[0]))
    return Facts(
        title="brake-cal demo",
        verdict=verdict,
        word=WORDS[verdict],
        headline=f"{passed} of {counted(len(ran), 'command')} gave what was expected",
        next="brake-cal manual",
        tables=[
            _table("What was done; each command can be typed again in this folder.",
                   {s.purpose: s for s in ran if not s.figure}, ran, folder),
            _table("The paper's figures, drawn with these cars.",
                   {f"Fig. {s.figure}: {s.purpose}": s for s in drawn}, ran, folder),
        ],
    )  # fmt: skip


def _table(caption: str, steps: Mapping[str, Step], ran: Mapping[Step, Ran], folder: Path) -> Table:
    """The steps by their names; each that left a page or a picture links it."""
    rows = [(name, step.line, ran[step].answer) for name, step in steps.items()]
    verdicts = [PASSED if ran[step].passed else FAILED for step in steps.values()]
    links = [step.leaves if ran[step].passed else "" for step in steps.values()]
    images = [_thumbnail(folder / link) if link.endswith(".png") else "" for link in links]
    return Table(("step", "command", "answer"), rows, caption, verdicts, links, images)


def _thumbnail(picture: Path) -> str:
    """A picture in small, as a data URI: means over squares of pixels."""
    from matplotlib.image import imread, imsave

    pixels, buffer = imread(picture), io.BytesIO()
    step = max(1, pixels.shape[1] // _THUMBNAIL)
    height, width = (step * (size // step) for size in pixels.shape[:2])
    squares = pixels[:height, :width, :3].reshape(height // step, step, width // step, step, 3)
    imsave(buffer, np.rint(_SHADES * squares.mean(axis=(1, 3))) / _SHADES, format="png")
    return f"data:image/png;base64,{base64.b64encode(buffer.getvalue()).decode()}"

"""The demo: command lines on the sample logs, and the index of what they answered and left.

A line needs what those before it made. Answers are known, since true torques and causes are.
"""

from collections.abc import Mapping
from dataclasses import dataclass

from calib.base.plain import counted, rows
from calib.show.facts import FAILED, PASSED, WORDS, Facts, Table

INDEX = "index.html"
_FOLDERS = {
    "sample_logs": "logs and vehicle files",
    "tables": "the store of the tables",
    "results": "each stop, sample by sample",
    "diagnosis": "what is missing in the model, and replays with and without it",
}


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


def demo_facts(ran: Mapping[Step, Ran]) -> Facts:
    """The index; its links lead from the folder of the demo."""
    passed = sum(one.passed for one in ran.values())
    verdict = PASSED if passed == len(ran) else FAILED
    drawn = sorted((s for s in ran if s.figure), key=lambda s: int(s.figure.split()[0]))
    return Facts(
        title="brake-cal demo",
        verdict=verdict,
        word=WORDS[verdict],
        headline=f"{passed} of {counted(len(ran), 'command')} gave what was expected",
        tables=[
            _table("What was done; each command can be typed again in this folder.",
                   {s.purpose: s for s in ran if not s.figure}, ran),
            _table("The paper's figures, drawn with these cars.",
                   {f"Fig. {s.figure}: {s.purpose}": s for s in drawn}, ran),
            Table(("folder", "what is in it"), list(_FOLDERS.items()), links=list(_FOLDERS)),
        ],
    )  # fmt: skip


def _table(caption: str, steps: Mapping[str, Step], ran: Mapping[Step, Ran]) -> Table:
    cells = [(name, step.line, ran[step].answer) for name, step in steps.items()]
    verdicts = [PASSED if ran[step].passed else FAILED for step in steps.values()]
    links = [step.leaves if ran[step].passed else "" for step in steps.values()]
    return Table(("step", "command", "answer"), cells, caption, verdicts, links)

"""A result as facts: each sentence is made once, for the terminal and for the page.

    a result --facts_of--> Facts --calib.show.terminal-> lines and grids
                                 --calib.show.html-----> one file

A terminal prints parts only with -v, and no pictures; it has warnings on stderr.
"""

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from calib.base.warning import PlausibilityWarning

if TYPE_CHECKING:
    from calib.show.sheet import Sheet

DIR = "DIR"
"""Stands for the folder of --out in the next step."""
Row = tuple[str, str]
"""A name and its text."""
PASSED, WARNING, FAILED, UNJUDGED = "passed", "warning", "failed", "unjudged"
"""Verdicts, which colour the head of a page, a section or a row; "" for none."""
_NUMBER = re.compile(r"[+-]?(\d[\d.]*(e[+-]\d+)?)?")
WORDS = {PASSED: "Passed", WARNING: "Passed with warnings", FAILED: "Failed"}


@dataclass(frozen=True)
class Table:
    """Cells as texts; the first cell of a row names it.

    ``verdicts``, and ``links`` and ``images`` of the first cell have one entry a row, "" for none.
    """

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    caption: str = ""
    verdicts: Sequence[str] = ()
    links: Sequence[str] = ()
    images: Sequence[str] = ()

    @cached_property
    def numeric(self) -> tuple[bool, ...]:
        """Whether each column but the first holds numbers, by the first words of its cells.

        >>> Table(("log", "valid"), [("stop", "95 %"), ("bend", "-")]).numeric
        (False, True)
        """
        columns = ([row[i].split() for row in self.rows] for i in range(1, len(self.heads)))
        firsts = ([words[0] for words in column if words] for column in columns)
        return False, *(bool(f) and all(map(_NUMBER.fullmatch, f)) for f in firsts)


@dataclass(frozen=True)
class Picture:
    """A sheet that is drawn when a page needs it; ``names`` of the panels shown, else all."""

    caption: str
    make: "Callable[[], Sheet]"
    names: Sequence[str] = ()


@dataclass(frozen=True)
class Facts:
    """A result, or a part of one; what is empty is not shown.

    Attributes
    ----------
    title : of the page or of the part.
    verdict, word : `PASSED` and so on, and the verdict as people say it.
    headline : the result in a sentence or two.
    numbers : the most important, each with its name.
    rows : names and their texts.
    tables, notes, warnings, pictures : in this order.
    next : what to do next, a command where there is one.
    parts : details, such as of each stop.
    """

    title: str = ""
    headline: str = ""
    verdict: str = ""
    word: str = ""
    numbers: Sequence[Row] = ()
    rows: Sequence[Row] = ()
    tables: Sequence[Table] = ()
    notes: Sequence[str] = ()
    next: str = ""
    warnings: Sequence[PlausibilityWarning] = ()
    pictures: Sequence[Picture] = ()
    parts: "Sequence[Facts]" = ()

    @property
    def verdict_line(self) -> str:
        """The verdict and the headline in one line; "" without both."""
        return ": ".join(text for text in (self.word, self.headline) if text)

    def written(self, folder: Path | None) -> "Facts":
        """The facts with the ``folder`` that was written for the `DIR` of the next step."""
        return self if folder is None else replace(self, next=self.next.replace(DIR, str(folder)))

    @property
    def filled(self) -> bool:
        """Whether there is anything below the title."""
        tables = any(table.rows for table in self.tables)
        others = (self.headline, self.numbers, self.rows, self.notes, self.warnings, self.pictures)
        return tables or any(others) or any(part.filled for part in self.parts)


_FACTS = {
    "Diagnosis": "diagnosis:diagnosis_facts",
    "Fitted": "fit:fit_facts",
    "GaugeStudy": "repeatability:gauge_facts",
    "Plan": "plan:plan_facts",
    "StationRun": "station_page:station_facts",
    "Stored": "store:table_facts",
    "Summary": "fleet:fleet_facts",
    "Validated": "validation:validation_facts",
    "Vehicle": "vehicle:vehicle_facts",
}
"""The function of each kind of result, by the name of its class."""


def facts_of(result: object) -> Facts:
    """Facts of a result; its module is imported here. Raises KeyError for another kind."""
    if isinstance(result, Facts):
        return result
    module, _, name = _FACTS[type(result).__name__].partition(":")
    facts: Facts = getattr(import_module(f"calib.show.{module}"), name)(result)
    return facts

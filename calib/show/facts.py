"""Facts: what is said of a result, once for the terminal and for the page.

    a result --facts_of--> Facts --calib.show.terminal--> lines and grids
                                 --calib.show.html------> one HTML file

A page shows all facts. A terminal prints no pictures, and the parts only with -v; the command
prints the warnings on stderr.
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
"""Placeholder of the folder of --out in the text of the next step."""
Row = tuple[str, str]
"""A name and its text."""
PASSED, WARNING, FAILED, UNJUDGED = "passed", "warning", "failed", "unjudged"
"""Verdicts, which colour the head of a page, a section or a row; "" for none."""
_NUMBER = re.compile(r"[+-]?(\d[\d.]*(e[+-]\d+)?)?")
"""Pattern of a number, of a sign alone and of an empty text."""
WORDS = {PASSED: "Passed", WARNING: "Passed with warnings", FAILED: "Failed"}
"""Verdicts as people say them."""


@dataclass(frozen=True)
class Table:
    """A table of texts; the first cell of a row names the row.

    Attributes
    ----------
    heads, rows : heads of the columns, and the cells of each row.
    caption : a sentence above the table.
    verdicts : verdict of each row, "" for none; () if no row has one.
    links, images : addresses of a link and of a picture in the first cell of each row, "" for none;
        () if no row has one.
    """

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    caption: str = ""
    verdicts: Sequence[str] = ()
    links: Sequence[str] = ()
    images: Sequence[str] = ()

    @cached_property
    def numeric(self) -> tuple[bool, ...]:
        """Whether each column holds numbers, by the first word of its cells; the first one not.

        >>> Table(("log", "valid"), [("stop", "95 %"), ("bend", "-")]).numeric
        (False, True)
        """
        numeric = [False]
        for column in range(1, len(self.heads)):
            cells = [row[column].split() for row in self.rows]
            first_words = [words[0] for words in cells if words]
            numeric.append(bool(first_words) and all(map(_NUMBER.fullmatch, first_words)))
        return tuple(numeric)


@dataclass(frozen=True)
class Picture:
    """A picture of a page: of the sheet that ``make`` returns the panels ``names``, () for all."""

    caption: str
    make: "Callable[[], Sheet]"
    names: Sequence[str] = ()


@dataclass(frozen=True)
class Facts:
    """What is said of a result, or of a part of a result; empty fields are not shown.

    Attributes
    ----------
    title : title of the page or of the part.
    headline : the result in a sentence or two.
    verdict : `PASSED`, `WARNING`, `FAILED` or `UNJUDGED`.
    word : the verdict as people say it.
    numbers : the most important numbers, each with its name.
    rows : other names with their texts.
    tables, notes, warnings, pictures : as their names say.
    next : what to do next; a command where there is one.
    parts : details, such as those of each stop.
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
        """Return the facts with the ``folder`` of --out in place of `DIR` in the next step."""
        return self if folder is None else replace(self, next=self.next.replace(DIR, str(folder)))

    @property
    def filled(self) -> bool:
        """Whether there is anything below the title."""
        filled = [self.headline, self.numbers, self.rows, self.notes, self.warnings, self.pictures]
        filled += [table.rows for table in self.tables]
        return any(filled) or any(part.filled for part in self.parts)


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
"""Module and function that tell a result, by the name of the result's class."""


def facts_of(result: object) -> Facts:
    """Return the facts of a result by the function of its class; Facts are returned as they are.

    Raises KeyError for a class that `_FACTS` does not have.
    """
    if isinstance(result, Facts):
        return result
    module, _, name = _FACTS[type(result).__name__].partition(":")
    facts: Facts = getattr(import_module(f"calib.show.{module}"), name)(result)
    return facts

"""Facts: the texts, tables and pictures that present a result, on a terminal and on a page.

    a result --facts_of--> Facts --calib.show.terminal--> lines and grids
                                 --calib.show.html------> one HTML file

A page shows all facts. A terminal shows no pictures, and the parts only with -v; the command
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
"""Placeholder for the folder of --out in `Facts.next`."""
Row = tuple[str, str]
"""A name and its text."""
PASSED, WARNING, FAILED, UNJUDGED = "passed", "warning", "failed", "unjudged"
"""Verdicts, which colour the head of a page, a section or a row; "" for none."""
WORDS = {PASSED: "Passed", WARNING: "Passed with warnings", FAILED: "Failed"}
"""Verdicts as people say them."""
_NUMBER = re.compile(r"[+-]?(\d[\d.]*(e[+-]\d+)?)?")
"""Pattern of a number, and of "-", which stands for no value."""


@dataclass(frozen=True)
class Table:
    """A table of texts; the first cell of a row names the row."""

    heads: Sequence[str]
    rows: Sequence[Sequence[str]]
    caption: str = ""  # a sentence above the table
    # for each row, "" for none; () if no row has one
    verdicts: Sequence[str] = ()
    links: Sequence[str] = ()  # address that the first cell leads to
    images: Sequence[str] = ()  # address of a picture in the first cell

    @cached_property
    def numeric(self) -> tuple[bool, ...]:
        """Whether each column holds numbers, by the first words of its cells; the first never does.

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
    """A picture of a page: the panels ``names``, () for all, of the sheet that ``make`` returns."""

    caption: str
    make: "Callable[[], Sheet]"
    names: Sequence[str] = ()


@dataclass(frozen=True)
class Facts:
    """What is said of a result, or of a part of a result; empty fields are not shown."""

    title: str = ""
    headline: str = ""  # the result in a sentence or two
    verdict: str = ""  # `PASSED`, `WARNING`, `FAILED` or `UNJUDGED`
    word: str = ""  # the verdict as people say it
    numbers: Sequence[Row] = ()  # the most important numbers
    rows: Sequence[Row] = ()  # other names with their texts
    tables: Sequence[Table] = ()
    notes: Sequence[str] = ()  # further sentences
    next: str = ""  # what to do next; a command if there is one for it
    warnings: Sequence[PlausibilityWarning] = ()
    pictures: Sequence[Picture] = ()
    parts: "Sequence[Facts]" = ()  # details, such as those of each stop

    @property
    def verdict_line(self) -> str:
        """The verdict and the headline in one line; "" without both."""
        return ": ".join(text for text in (self.word, self.headline) if text)

    def with_folder(self, folder: Path | None) -> "Facts":
        """Return the facts with the ``folder`` of --out in place of `DIR` in the next step."""
        return self if folder is None else replace(self, next=self.next.replace(DIR, str(folder)))

    @property
    def has_content(self) -> bool:
        """Whether there is anything below the title."""
        fields = [self.headline, self.numbers, self.rows, self.notes, self.warnings, self.pictures]
        fields += [table.rows for table in self.tables]
        return any(fields) or any(part.has_content for part in self.parts)


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
"""Module and function that make the facts of a class of results; imported when needed."""


def facts_of(result: object) -> Facts:
    """Return the facts of a result, or facts as they are. Raises KeyError for an unknown class."""
    if isinstance(result, Facts):
        return result
    module, _, name = _FACTS[type(result).__name__].partition(":")
    facts: Facts = getattr(import_module(f"calib.show.{module}"), name)(result)
    return facts

"""HTML pages, one file each: a `Report` is written block by block, from plain texts and numbers.

Style and figures are inside the file; a page fetches nothing and has no scripts. The templates
escape every text.
"""

import base64
import itertools
from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING, Any

from calib.base.plain import METRICS
from calib.base.warning import PlausibilityWarning
from calib.show.facts import Facts, Table
from calib.show.facts import Picture as Shown
from calib.show.sheet import Sheet, render

if TYPE_CHECKING:
    from jinja2 import Environment


GENERATOR = "brake-cal"
"""What every page says of the program that wrote it."""

HEAD = 1000
"""Bytes at the begin of a page that hold its generator."""

PANEL = (4.6, 3.1)
"""Size of a panel of a page [in]: legible on a telephone."""


Block = tuple[str, tuple[Any, ...]]
"""Name of a macro of `parts.html.j2`, and what it is given."""
Rows = Iterable[Sequence[object]]
AGAINST = "What speaks against the result, although it is given."
WARNING_HEADS = ("warning", "measured", "likely", "what to do")


@dataclass(frozen=True)
class Picture:
    """A figure inside a page: ``key`` is the id of the box that enlarges it, empty without one.

    ``more``: sources of the panels beside the first one, on a narrow screen below it.
    """

    source: str
    key: str = ""
    more: tuple[str, ...] = ()


@cache
def environment() -> "Environment":
    """The templates of all pages. A name to which a page gives no value is an UndefinedError."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    made = Environment(
        loader=PackageLoader("calib.show"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )
    made.globals["generator"] = GENERATOR
    return made


def page(template: str, /, **view: object) -> str:
    """The document that ``template`` makes of ``view``."""
    return environment().get_template(f"{template}.html.j2").render(view)


def page_of(facts: Facts, again: int = 0) -> str:
    """One HTML file without scripts, which fetches nothing; equal facts give equal bytes.

    It loads itself again after ``again`` [s], 0: never.
    """
    number = itertools.count(1)
    return (
        environment()
        .get_template("page.html.j2")
        .render(
            facts=facts,
            again=again,
            sources=_sources,
            warned=_warned,
            key=lambda: f"zoom-{next(number)}",
        )
        .lstrip()
    )


def _sources(one: Shown) -> list[str]:
    """Each panel as a drawing of its own, so that a narrow screen can show one below the other."""
    if isinstance(one.of, bytes):
        kind = "png" if one.of.startswith(b"\x89PNG") else "svg+xml"
        return [picture(one.of, kind).source]
    part, sources = replace(one.of, title="", result="", note=""), []
    for name in one.names or part.names:
        figure = part.figure(name)
        figure.set_size_inches(*PANEL)
        sources.append(picture(render(figure, ".svg"), "svg+xml").source)
    return sources


def _warned(warnings: Sequence[PlausibilityWarning]) -> Table:
    """What and where, measured and expected, likely causes, what to do."""
    rows = []
    for w in warnings:
        name, amount, expected = w.code.replace("_", " "), w.amount, w.bounds
        if known := METRICS.get(w.code):
            name, amount = known.name, known.with_unit(w.measured)
            expected = known.bounds(*w.expected)
        causes = ", or ".join(w.causes)
        rows.append((f"{w.log}: {name}", f"{amount}; expected {expected}", causes, w.do))
    return Table(WARNING_HEADS, rows, AGAINST, ["warning"] * len(rows))


def is_page(data: bytes) -> bool:
    """Whether the bytes of a file are those of a page as it is written here."""
    return f'<meta name="generator" content="{GENERATOR}">'.encode() in data[:HEAD]


class Report:
    """A page that is written from top to bottom: its head, then sections with their blocks.

    ``kind`` is the class of the head, ``body`` that of the page. A block without content is left
    out, and so is a section without blocks.
    """

    def __init__(self, title: str, heading: str, kind: str = "", verdict: str = "", body: str = ""):
        self.head = {"title": title, "heading": heading, "kind": kind, "verdict": verdict}
        self.body = body
        self.lead: list[Block] = []
        self.sections: list[Block] = []
        self._here = self.lead

    def html(self) -> str:
        """The document."""
        there = [block for block in self.sections if block[1][1]]
        return page("report", **self.head, body=self.body, lead=self.lead, sections=there)

    def add(self, macro: str, *given: object) -> None:
        """Add a block by the name of its macro."""
        self._here.append((macro, given))

    def section(self, title: str, kind: str = "", of: str = "") -> None:
        """Begin a section; ``kind`` is the class of its title, ``of`` that of the section."""
        self._here = []
        self.sections.append(("section", (title, self._here, kind, of)))

    @contextmanager
    def inside(self, macro: str, *given: object) -> Iterator[None]:
        """Blocks inside another one: ``fold`` with its title, or ``on_screen``."""
        outer, self._here = self._here, []
        yield
        inner, self._here = self._here, outer
        if inner:
            self.add(macro, *given, inner)

    def text(self, *sentences: str | None) -> None:
        """A paragraph of those ``sentences`` that are there."""
        if words := " ".join(sentence for sentence in sentences if sentence):
            self.add("text", words)

    def listing(self, items: Iterable[object]) -> None:
        """A list with a dot before each text."""
        if there := list(items):
            self.add("listing", there)

    def terms(self, rows: Mapping[str, object] | Iterable[tuple[str, object]]) -> None:
        """Names, each with its description."""
        if there := list(dict(rows).items() if isinstance(rows, Mapping) else rows):
            self.add("terms", there)

    def table(
        self,
        caption: str,
        heads: Sequence[str],
        rows: Rows,
        of: str = "plain",
        kinds: Sequence[str] = (),
    ) -> None:
        """A table whose first cells name the rows; ``kinds`` has a class for each row."""
        if there := list(rows):
            self.add("table", caption, heads, there, of, kinds)

    def warnings(self, warnings: Iterable[Sequence[str]], caption: str = AGAINST) -> None:
        """A section of warnings, as `calib.show.judged.warned` writes them."""
        there = list(warnings)
        self.section("Warnings")
        self.table(caption, WARNING_HEADS, there, "steps", ["warning"] * len(there))

    def figure(self, picture: Picture, caption: str) -> None:
        """A picture, which is read aloud as its caption."""
        self.add("figure", picture, caption, caption)


def picture(content: bytes, kind: str, key: str = "") -> Picture:
    """A picture of MIME type image/``kind`` from its bytes, for use inside a page."""
    return Picture(f"data:image/{kind};base64,{base64.b64encode(content).decode()}", key)


def drawn(sheet: Sheet, *names: str, key: tuple[str, ...] = ()) -> Picture:
    """Panels of the sheet as one picture that can be enlarged.

    Each panel is a drawing of its own, so that a narrow screen shows them one below the other.
    ``key`` makes the id of the box unique, where a page shows panels of one name more than once.
    Raises KeyError for a name that the sheet does not have.
    """
    from calib.show.sheet import render

    part, sources = replace(sheet, title="", result="", note=""), []
    for name in names:
        figure = part.figure(name)
        figure.set_size_inches(*PANEL)
        sources.append(picture(render(figure, ".svg"), "svg+xml").source)
    return Picture(sources[0], "zoom-" + "-".join((*key, *names)), tuple(sources[1:]))

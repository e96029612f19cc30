"""Facts as one HTML file: style, pictures and scripts are inside, and all is escaped.

Only a live page has scripts, those of `calib.show.interactive`; it can be read without them.
"""

import json
import re
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING
from urllib.parse import quote

from calib.base.templates import templates
from calib.base.warning import PlausibilityWarning
from calib.show.facts import Facts, Picture, Table
from calib.show.interactive import Drawn, drawn, source
from calib.show.numbers import whole
from calib.show.sheet import Sheet, render

if TYPE_CHECKING:
    from jinja2 import Template

_GENERATOR = "brake-cal"
"""Generator of every page, by which one is recognised."""
_HEAD = 1000
"""First bytes of a page, which hold its generator."""
_PANEL = (4.6, 3.1)
"""Size of a panel of a page [in]: legible on a telephone."""
_PARTS = 120
"""Parts of a long line in a panel: two pixels of a screen each."""
_UNQUOTED = " =/:;,.()+-*@!?[]{}|~\n"
"""Characters that need no escape in a data URI within HTML."""
_UNSEEN = re.compile(
    r"^.*?(?=<svg)|<metadata>.*?</metadata>|<!--.*?-->|\n *(?=<)"
    r"| id=\"[a-z2]+_\d+\"| transform=\"rotate\(-0 [^\"]*\"",
    re.DOTALL,
)
"""Parts of an SVG that show nothing: prologue, metadata, comments, spaces, names, turns by 0."""
_PLACE = re.compile(r"(?<=[\s\"])-?\d+\.\d{3,}(?=[\s\"])(?=[^<>]*>)")
_STRAIGHT = re.compile(r"(?<= d=\")M(?: [-\d.]+ [-\d.]+ \n[LM])+ [-\d.]+ [-\d.]+ \n(?=z?\n?\")")
_FONT = "'DejaVu Sans'", "'DejaVu Sans', Verdana, sans-serif"
"""Font of the letters, and the same with fonts of its width for machines without it."""
_AGAINST = "What speaks against the result, although it is given."


@cache
def _template() -> "Template":
    pages = templates("calib.show", markup=True)
    pages.finalize = lambda value: whole(value) if type(value) is str else value
    return pages.get_template("page.html.j2")


def page_of(facts: Facts, again: int = 0, live: bool = False) -> str:
    """The page, which fetches nothing; equal facts give equal bytes.

    It loads itself again after ``again`` [s], 0: never. Sheets of a ``live`` one can be zoomed on
    a screen, by scripts that are inside; it needs Bokeh.
    """
    pictures = _Pictures(live)
    text = _template().render(
        facts=facts, again=again, generator=_GENERATOR, pictures=pictures, warned=_warned
    )
    return text.lstrip()


def is_page(data: bytes) -> bool:
    """Whether the bytes of a file are those of a page as it is written here."""
    return f'<meta name="generator" content="{_GENERATOR}">'.encode() in data[:_HEAD]


class _Pictures:
    """The pictures of a page as panels; ``drawn`` are the interactive ones."""

    def __init__(self, live: bool) -> None:
        self.live, self.drawn = live, list[Drawn]()

    def panels(self, picture: Picture) -> list[tuple[str, str]]:
        """Each panel as SVG, with the place of its live picture, or ""."""
        sheet = picture.make()
        names = picture.names or sheet.names
        places = dict.fromkeys(names, "")
        if self.live:
            self.drawn.append(drawn(sheet, names, f"sheet-{len(self.drawn)}"))
            places = self.drawn[-1].places
        return [(_panel(sheet, name), places[name]) for name in names]

    @property
    def source(self) -> str:
        """The source of Bokeh; "" where no picture is live."""
        return source() if self.drawn else ""

    @property
    def calls(self) -> list[str]:
        """Script that fills each interactive picture, escaped for HTML."""
        return [
            f"live({one.data}, {json.dumps(one.roots)});".replace("<", "\\u003c")
            for one in self.drawn
        ]


def _panel(sheet: Sheet, name: str) -> str:
    """A panel as a small SVG, since a page has many."""
    figure = replace(sheet, title="", result="", note="").figure(name, _PANEL, _PARTS)
    svg = render(figure, ".svg", text=True).decode().replace(*_FONT)
    # places are exact to a tenth of a point
    short = _PLACE.sub(lambda found: f"{float(found[0]):.1f}", _UNSEEN.sub("", svg))
    image = _STRAIGHT.sub(_from_last, short).encode()
    return f"data:image/svg+xml,{quote(image, safe=_UNQUOTED)}"


def _from_last(path: re.Match[str]) -> str:
    """A path of straight lines in relative coordinates, which is half as long."""
    commands, last, text = path[0].split("\n"), (0, 0), ""
    for command in filter(None, commands):
        letter, *place = command.split()
        x, y = (round(10.0 * float(end)) for end in place)
        dx, dy = (f"{0.1 * way:.1f}".removesuffix(".0") for way in (x - last[0], y - last[1]))
        text, last = f"{text}{letter.lower()}{dx}{' ' * (dy[0] != '-')}{dy}", (x, y)
    return text


def _warned(warnings: Sequence[PlausibilityWarning]) -> Table:
    """One row a warning: log and quantity, value and range, causes, next step."""
    rows = [
        (f"{w.log}: {w.title}", f"{w.amount}; expected {w.bounds}",
         ", or ".join(w.causes), w.do)
        for w in warnings
    ]  # fmt: skip
    heads = ("warning", "measured", "likely", "what to do")
    return Table(heads, rows, _AGAINST, ["warning"] * len(rows))

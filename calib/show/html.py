"""Facts as one HTML file, which holds its style, pictures and scripts; all texts are escaped.

A page can be read and printed without scripts. One script sorts and filters tables. A live page
also holds Bokeh and what `calib.show.interactive` makes of each sheet, packed for a browser.
"""

import base64
import hashlib
import re
import zlib
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING
from urllib.parse import quote

import numpy as np

from calib.base.templates import templates
from calib.base.warning import PlausibilityWarning
from calib.show.facts import Facts, Picture, Table
from calib.show.interactive import script, source
from calib.show.numbers import unbroken
from calib.show.sheet import Sheet, render

if TYPE_CHECKING:
    from jinja2 import Template

_GENERATOR, _HEAD = "brake-cal", 1000
"""Generator that every page names, and the number of its first bytes that hold this name."""
_LONG = 3
"""Fewest rows of a table that can be sorted."""
_ROOM = 900_000
"""Letters for the live pictures of a page; Bokeh has 400,000, the still pictures about 200,000."""
_PANEL, _PARTS = (4.6, 3.1), 120
"""Size of a panel [in], legible on a telephone; parts of the `envelope` of a line, of 2 px each."""
_UNQUOTED = " =/:;,.()+-*@!?[]{}|~\n<>'"
"""Characters that need no escape in a data URI within double quotes."""
_UNSEEN = re.compile(
    r"^.*?(?=<svg)|<metadata>.*?</metadata>|<!--.*?-->|\n *(?=<)|font-family: 'DejaVu Sans';? ?"
    r"| id=\"[a-z2]+_\d+\"| transform=\"rotate\(-0 [^\"]*\"",
    re.DOTALL,
)
"""Parts of an SVG that show nothing, and the font of each element, which `_FONT` names once."""
_TAG = re.compile("<[^<>']*>")
"""A tag without an apostrophe, whose quotes become apostrophes."""
_STYLE, _FONT = "<style type='text/css'>*{", "font-family: DejaVu Sans, Verdana, sans-serif; "
"""Start of the style of an SVG; font of all texts, and fonts of similar width in its place."""
_PLACE = re.compile(r"(?<=[\s\"])-?\d+\.\d{3,}(?=[\s\"])(?=[^<>]*>)")
"""A coordinate with three decimals or more, inside a tag."""
_STRAIGHT = re.compile(r"M(?: [-\d.]+ [-\d.]+ \nL)+ [-\d.]+ [-\d.]+ \n(?=z?\n?\"|M)")
"""A line of straight pieces; a path with gaps has several."""
_HALF_A_PIXEL = 1.0 / 3.0
"""Distance by which a shortened line may leave the line [pt]: half a pixel of a wide screen."""
_WARNINGS = "What speaks against the result, although it is given."


@cache
def _template() -> "Template":
    """Return the template of a page, which keeps numbers and units together."""
    pages = templates("calib.show", markup=True)
    # Markup is a subclass of str, and escaped already
    pages.finalize = lambda value: unbroken(value) if type(value) is str else value
    return pages.get_template("page.html.j2")


def page_of(facts: Facts, again: int = 0, live: bool = False) -> str:
    """Return the page of the facts, which fetches nothing; equal facts give equal bytes.

    With ``again`` above 0 the page loads itself again after so many seconds, until a reader stops
    that. Pictures of a ``live`` page can be zoomed; this needs Bokeh.
    """
    acting = _asset("reload.js") if again else ""
    acting += _asset("tables.js") if _has_long_table(facts) else ""
    digest = base64.b64encode(hashlib.sha256(acting.encode()).digest()).decode()
    page = {
        "facts": facts,
        "again": again,
        "generator": _GENERATOR,
        "pictures": _Pictures(live),
        "drawing": _drawing,
        "acting": acting,
        "allowed": "'unsafe-inline'" if live else f"'sha256-{digest}'" if acting else "'none'",
        "warned": _warned,
    }
    return _template().render(page).lstrip()


def _has_long_table(facts: Facts) -> bool:
    """Whether the page has a table that is worth sorting."""
    tables = [len(facts.warnings), *(len(table.rows) for table in facts.tables)]
    return max(tables) >= _LONG or any(map(_has_long_table, facts.parts))


def _asset(name: str) -> str:
    return (Path(__file__).parent / "templates" / name).read_text(encoding="utf-8")


def _packed(text: str) -> str:
    """Return a script, packed by zlib, in base64."""
    return base64.b64encode(zlib.compress(text.encode(), 9)).decode()


@cache
def _drawing() -> str:
    return _packed(f"{source()}\n{_asset('live.js')}")


def is_page(data: bytes) -> bool:
    """Return whether the bytes of a file are those of a page."""
    return f'<meta name="generator" content="{_GENERATOR}">'.encode() in data[:_HEAD]


class _Pictures:
    """The pictures of a page, and the packed ``scripts`` of its live pictures.

    Of a ``live`` page the first picture is live, and those after it for which there is room.
    """

    def __init__(self, live: bool) -> None:
        self.live, self.scripts = live, list[str]()

    def panels(self, picture: Picture) -> list[tuple[str, str]]:
        """Return each panel as SVG, with the id of the place of its live picture, "" for none."""
        sheet = picture.make()
        names = picture.names or sheet.names
        stills = [_panel(sheet, name) for name in names]
        places = [f"sheet-{len(self.scripts)}-{i}" for i in range(len(names))]
        if self.live:
            drawing = _packed(script(sheet, dict(zip(names, places, strict=True))))
            if not self.scripts or sum(map(len, self.scripts)) + len(drawing) <= _ROOM:
                self.scripts.append(drawing)
                return list(zip(stills, places, strict=True))
        return [(still, "") for still in stills]


def _panel(sheet: Sheet, name: str) -> str:
    """Return a panel as a data URI of an SVG that is made small, as a page has many panels."""
    figure = replace(sheet, title="", result="", note="").figure(name, _PANEL, _PARTS)
    svg = _UNSEEN.sub("", render(figure, ".svg", text=True).decode())
    # round coordinates to a tenth of a point
    short = _PLACE.sub(lambda place: f"{float(place[0]):.1f}", _STRAIGHT.sub(_shortened, svg))
    short = _TAG.sub(lambda tag: tag[0].replace('"', "'"), short)
    short = short.replace(_STYLE, _STYLE + _FONT, 1)
    while "<g></g>" in short:
        short = short.replace("<g></g>", "")
    return f"data:image/svg+xml,{quote(short.encode(), safe=_UNQUOTED)}"


def _shortened(path: re.Match[str]) -> str:
    """Return a line in relative coordinates, without points that cannot be seen."""
    from matplotlib.path import Path

    points = [point.split() for point in path[0].removeprefix("M").split("L")]
    line = Path(np.array(points, float))
    line.should_simplify, line.simplify_threshold = True, _HALF_A_PIXEL
    visible = np.asarray(line.cleaned(simplify=True).vertices)[:-1]  # (m, 2), without its end mark
    first, *steps = 0.1 * np.diff(np.rint(10.0 * visible), axis=0, prepend=0.0)
    moves = []
    for step in (first, *(step for step in steps if step.any())):
        x, y = (f"{way:.1f}".removesuffix(".0") for way in step)
        moves.append(f"{x}{y}" if y.startswith("-") else f"{x} {y}")
    return "M" + "l".join(moves)


def _warned(warnings: Sequence[PlausibilityWarning]) -> Table:
    rows = [
        (f"{w.log}: {w.title}", f"{w.amount}; expected {w.bounds}",
         ", or ".join(w.causes), w.do)
        for w in warnings
    ]  # fmt: skip
    heads = ("warning", "measured", "likely", "what to do")
    return Table(heads, rows, _WARNINGS, ["warning"] * len(rows))

"""Facts as one HTML file, which holds its style, pictures and scripts; all texts are escaped.

A page can be read and printed without scripts. One script sorts and filters tables. A live page
also holds Bokeh and the script of `calib.show.interactive` for each sheet.
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
from calib.show.interactive import script_of, source
from calib.show.numbers import unbroken
from calib.show.sheet import Sheet, render

if TYPE_CHECKING:
    from jinja2 import Template

_GENERATOR, _HEAD = "brake-cal", 1000
"""Generator that every page names, and the number of its first bytes that hold this name."""
_ROOM = 900_000
"""Letters for the live pictures of a page; Bokeh has 400,000, the still pictures about 200,000."""
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
_LINE = re.compile(r"M(?: [-\d.]+ [-\d.]+ \nL)+ [-\d.]+ [-\d.]+ \n(?=z?\n?\"|M)")
"""A line of straight pieces; a path with gaps has several."""


@cache
def _template() -> "Template":
    """Return the template of a page, which keeps numbers and units together."""
    pages = templates("calib.show", markup=True)
    # `Markup` of Jinja is a str, too, but needs no change
    pages.finalize = lambda value: unbroken(value) if type(value) is str else value
    return pages.get_template("page.html.j2")


def page_of(facts: Facts, again: int = 0, live: bool = False) -> str:
    """Return the page of the facts, which fetches nothing; equal facts give equal bytes.

    With ``again`` above 0 the page reloads itself every ``again`` seconds, until a reader stops
    that. Pictures of a ``live`` page can be zoomed; this needs Bokeh.
    """
    script = _asset("reload.js") if again else ""
    script += _asset("tables.js") if _has_long_table(facts) else ""
    allowed_scripts = "'unsafe-inline'" if live else "'none'"
    if script and not live:
        digest = base64.b64encode(hashlib.sha256(script.encode()).digest()).decode()
        allowed_scripts = f"'sha256-{digest}'"
    page = _template().render(
        facts=facts,
        again=again,
        generator=_GENERATOR,
        pictures=_Pictures(live),
        packed_bokeh=_packed_bokeh,
        script=script,
        allowed_scripts=allowed_scripts,
        table_of_warnings=_table_of_warnings,
    )
    return page.lstrip()


def _has_long_table(facts: Facts) -> bool:
    """Whether the page has a table that `tables.js` can sort: three rows or more."""
    tables = [len(facts.warnings), *(len(table.rows) for table in facts.tables)]
    return max(tables) >= 3 or any(map(_has_long_table, facts.parts))


def _asset(name: str) -> str:
    return (Path(__file__).parent / "templates" / name).read_text(encoding="utf-8")


def _packed(text: str) -> str:
    return base64.b64encode(zlib.compress(text.encode(), 9)).decode()


@cache
def _packed_bokeh() -> str:
    """Return the scripts that all live pictures of a page need."""
    return _packed(f"{source()}\n{_asset('live.js')}")


def is_page(data: bytes) -> bool:
    """Return whether the bytes of a file are those of a page."""
    return f'<meta name="generator" content="{_GENERATOR}">'.encode() in data[:_HEAD]


class _Pictures:
    """The pictures of a page, and the packed ``scripts`` of its live pictures.

    On a ``live`` page the first picture is live, and so are later ones as far as `_ROOM` allows.
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
            packed = _packed(script_of(sheet, dict(zip(names, places, strict=True))))
            if not self.scripts or sum(map(len, self.scripts)) + len(packed) <= _ROOM:
                self.scripts.append(packed)
                return list(zip(stills, places, strict=True))
        return [(still, "") for still in stills]


def _panel(sheet: Sheet, name: str) -> str:
    """Return a panel as a data URI of an SVG, which is made small, as a page has many panels."""
    bare_sheet = replace(sheet, title="", result="", note="")
    figure = bare_sheet.figure(name, size=(4.6, 3.1), parts=120)  # legible on a telephone
    svg = _UNSEEN.sub("", render(figure, ".svg", text=True).decode())
    svg = _LINE.sub(_shortened, svg)
    svg = _PLACE.sub(lambda place: f"{float(place[0]):.1f}", svg)  # to a tenth of a point
    svg = _TAG.sub(lambda tag: tag[0].replace('"', "'"), svg)  # a quote would be %22
    svg = svg.replace(_STYLE, _STYLE + _FONT, 1)
    while "<g></g>" in svg:
        svg = svg.replace("<g></g>", "")
    return f"data:image/svg+xml,{quote(svg.encode(), safe=_UNQUOTED)}"


def _shortened(line: re.Match[str]) -> str:
    r"""Return a line from point to point by relative coordinates, without points that do not show.

    `M 1.5 2 \nL 3 4 \n` becomes `M1.5 2l1.5 2`.
    """
    from matplotlib.path import Path

    path = Path(np.array([point.split() for point in line[0].removeprefix("M").split("L")], float))
    path.should_simplify = True
    path.simplify_threshold = 1.0 / 3.0  # [pt]: half a pixel of a wide screen
    points = np.asarray(path.cleaned(simplify=True).vertices)[:-1]  # (m, 2), without its end mark
    tenths = np.rint(10.0 * points)  # tenths of a point
    first, *steps = 0.1 * np.diff(tenths, axis=0, prepend=0.0)  # [pt], the first from (0, 0)
    moves = []
    for step in (first, *(step for step in steps if step.any())):
        x, y = (f"{way:.1f}".removesuffix(".0") for way in step)
        moves.append(f"{x}{y}" if y.startswith("-") else f"{x} {y}")
    return "M" + "l".join(moves)


def _table_of_warnings(warnings: Sequence[PlausibilityWarning]) -> Table:
    heads = ("warning", "measured", "likely", "what to do")
    rows = [
        (f"{w.log}: {w.title}", f"{w.amount}; expected {w.bounds}", ", or ".join(w.causes), w.do)
        for w in warnings
    ]
    caption = "What speaks against the result, although it is given."
    return Table(heads, rows, caption, ["warning"] * len(rows))

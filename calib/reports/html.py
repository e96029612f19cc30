"""HTML pages, one file each: a template of `templates`, filled with plain texts and numbers.

Style and figures are inside the file; a page fetches nothing and has no scripts. The templates
escape every text, so a report passes plain text to them.
"""

import base64
from dataclasses import dataclass, replace
from functools import cache
from typing import TYPE_CHECKING

from calib.plots.sheet import Sheet

if TYPE_CHECKING:
    from jinja2 import Environment


GENERATOR = "brake-cal"
"""What every page says of the program that wrote it."""

HEAD = 1000
"""Bytes at the begin of a page that hold its generator."""

PANEL = (4.6, 3.1)
"""Size of a panel of a page [in]: legible on a telephone."""


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
        loader=PackageLoader("calib.reports"),
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


def is_page(data: bytes) -> bool:
    """Whether the bytes of a file are those of a page as it is written here."""
    return f'<meta name="generator" content="{GENERATOR}">'.encode() in data[:HEAD]


def picture(content: bytes, kind: str, key: str = "") -> Picture:
    """A picture of MIME type image/``kind`` from its bytes, for use inside a page."""
    return Picture(f"data:image/{kind};base64,{base64.b64encode(content).decode()}", key)


def drawn(sheet: Sheet, *names: str, key: tuple[str, ...] = ()) -> Picture:
    """Panels of the sheet as one picture that can be enlarged.

    Each panel is a drawing of its own, so that a narrow screen shows them one below the other.
    ``key`` makes the id of the box unique, where a page shows panels of one name more than once.
    Raises KeyError for a name that the sheet does not have.
    """
    from calib.plots.save import render

    part, sources = replace(sheet, title="", result="", note=""), []
    for name in names:
        figure = part.figure(name)
        figure.set_size_inches(*PANEL)
        sources.append(picture(render(figure, ".svg"), "svg+xml").source)
    return Picture(sources[0], "zoom-" + "-".join((*key, *names)), tuple(sources[1:]))

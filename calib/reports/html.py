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


@dataclass(frozen=True)
class Picture:
    """A figure inside a page: ``key`` is the id of the box that enlarges it, empty without one."""

    source: str
    key: str = ""


@cache
def environment() -> "Environment":
    """The templates of all pages. A name to which a page gives no value is an UndefinedError."""
    from jinja2 import Environment, PackageLoader, StrictUndefined

    return Environment(
        loader=PackageLoader("calib.reports"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
        keep_trailing_newline=True,
    )


def page(template: str, /, **view: object) -> str:
    """The document that ``template`` makes of ``view``."""
    return environment().get_template(f"{template}.html.j2").render(view)


def picture(content: bytes, kind: str, key: str = "") -> Picture:
    """A picture of MIME type image/``kind`` from its bytes, for use inside a page."""
    return Picture(f"data:image/{kind};base64,{base64.b64encode(content).decode()}", key)


def drawn(sheet: Sheet, *rows: tuple[str, ...]) -> Picture:
    """Panels of the sheet as one picture that can be enlarged; ``rows`` as in `Sheet`."""
    from calib.plots.save import render

    names = dict.fromkeys(name for row in rows for name in row)
    panels = tuple(panel for panel in sheet.panels if panel.name in names)
    part = replace(sheet, title="", note="", panels=panels, rows=rows, heights=())
    return picture(render(part.overview(), ".svg"), "svg+xml", "zoom-" + "-".join(names))

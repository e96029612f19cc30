"""Facts as one HTML file: style and pictures are inside, there are no scripts, all is escaped."""

import base64
from collections.abc import Sequence
from dataclasses import replace
from functools import cache
from typing import TYPE_CHECKING

from calib.base.plain import plain
from calib.base.warning import PlausibilityWarning
from calib.show.facts import Facts, Picture, Table
from calib.show.sheet import render

if TYPE_CHECKING:
    from jinja2 import Template

_GENERATOR = "brake-cal"
"""What every page says of the program that wrote it."""
_HEAD = 1000
"""Bytes at the begin of a page that hold its generator."""
_PANEL = (4.6, 3.1)
"""Size of a panel of a page [in]: legible on a telephone."""
_AGAINST = "What speaks against the result, although it is given."


@cache
def _template() -> "Template":
    from jinja2 import Environment, PackageLoader, StrictUndefined

    environment = Environment(
        loader=PackageLoader("calib.show"),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    return environment.get_template("page.html.j2")


def page_of(facts: Facts, again: int = 0) -> str:
    """The page, which fetches nothing; equal facts give equal bytes.

    It loads itself again after ``again`` [s], 0: never.
    """
    text = _template().render(
        facts=facts, again=again, generator=_GENERATOR, sources=_sources, warned=_warned
    )
    return text.lstrip()


def is_page(data: bytes) -> bool:
    """Whether the bytes of a file are those of a page as it is written here."""
    return f'<meta name="generator" content="{_GENERATOR}">'.encode() in data[:_HEAD]


def _sources(one: Picture) -> list[str]:
    """Each panel as a drawing of its own, so that a narrow screen can show one below the other."""
    if isinstance(one.of, bytes):
        return [_inside(one.of)]
    part, sources = replace(one.of, title="", result="", note=""), []
    for name in one.names or part.names:
        figure = part.figure(name)
        figure.set_size_inches(*_PANEL)
        sources.append(_inside(render(figure, ".svg")))
    return sources


def _inside(image: bytes) -> str:
    kind = "png" if image.startswith(b"\x89PNG") else "svg+xml"
    return f"data:image/{kind};base64,{base64.b64encode(image).decode()}"


def _warned(warnings: Sequence[PlausibilityWarning]) -> Table:
    """What and where, measured and expected, likely causes, what to do."""
    rows = [
        (f"{w.log}: {plain(w.code).name.replace('_', ' ')}", f"{w.amount}; expected {w.bounds}",
         ", or ".join(w.causes), w.do)
        for w in warnings
    ]  # fmt: skip
    heads = ("warning", "measured", "likely", "what to do")
    return Table(heads, rows, _AGAINST, ["warning"] * len(rows))

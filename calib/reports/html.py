"""Parts of a report: one self-contained HTML page, sections, tables, figures that can be enlarged.

Nothing in a page is fetched and nothing in it runs: style and figures are inside. Every string is
escaped here, so that whoever writes a report hands over plain text.
"""

import base64
from collections.abc import Sequence
from dataclasses import replace
from html import escape

from calib.plots.sheet import Sheet
from calib.reports.style import STYLE


def page(title: str, parts: Sequence[str]) -> str:
    """A whole document of ``parts``, which are HTML already; empty ones are left out."""
    return (
        '<!DOCTYPE html>\n<html lang="en">\n<head>\n<meta charset="utf-8">\n'
        '<meta name="viewport" content="width=device-width, initial-scale=1">\n'
        '<meta name="color-scheme" content="light dark">\n'
        '<link rel="icon" href="data:,">\n'
        f"<title>{escape(title)}</title>\n"
        f"<style>{STYLE}</style>\n</head>\n<body>\n<main>\n"
        + "\n".join(part for part in parts if part)
        + "\n</main>\n</body>\n</html>\n"
    )


def section(heading: str, *parts: str) -> str:
    """A section under a heading of the second level; empty parts are left out."""
    inside = "\n".join(part for part in parts if part)
    return f"<section>\n<h2>{escape(heading)}</h2>\n{inside}\n</section>"


def paragraph(text: str) -> str:
    """A paragraph; nothing for an empty text."""
    return f"<p>{escape(text)}</p>" if text else ""


def listing(items: Sequence[str]) -> str:
    """A list with a dot before each text; nothing without one."""
    inside = "".join(f"<li>{escape(item)}</li>" for item in items)
    return f"<ul>{inside}</ul>" if inside else ""


def terms(rows: Sequence[tuple[str, str]], kind: str = "card") -> str:
    """Names and what they stand for, as a list of definitions of class ``kind``."""
    inside = "".join(f"<dt>{escape(name)}</dt><dd>{escape(text)}</dd>" for name, text in rows)
    return f'<dl class="{escape(kind)}">{inside}</dl>' if inside else ""


def table(
    caption: str,
    heads: Sequence[str],
    rows: Sequence[Sequence[str]],
    kinds: Sequence[str] = (),
    of: str = "plain",
) -> str:
    """A table of class ``of`` whose first column names its rows; ``kinds`` gives each a class."""
    head = "".join(f'<th scope="col">{escape(name)}</th>' for name in heads)
    classes = [f' class="{escape(kind)}"' if kind else "" for kind in kinds] or [""] * len(rows)
    body = "".join(
        f'<tr{kind}><th scope="row">{escape(first)}</th>'
        + "".join(f"<td>{escape(cell)}</td>" for cell in cells)
        + "</tr>"
        for (first, *cells), kind in zip(rows, classes, strict=True)
    )
    return (
        f'<div class="wide" role="region" tabindex="0" aria-label="{escape(caption)}">'
        f'<table class="{escape(of)}"><caption>{escape(caption)}</caption>'
        f"<thead><tr>{head}</tr></thead><tbody>{body}</tbody></table></div>"
    )


def folded(summary: str, *parts: str) -> str:
    """Parts that are shown on demand, and always on paper where the reader prints them open."""
    return f"<details><summary>{escape(summary)}</summary>\n{chr(10).join(parts)}\n</details>"


def figure(sheet: Sheet, rows: tuple[tuple[str, ...], ...], alt: str, caption: str) -> str:
    """Panels of the sheet as one picture inside the document, with a box to enlarge it."""
    from calib.plots.save import render

    shown = {name for row in rows for name in row}
    panels = tuple(p for p in sheet.panels if p.name in shown)
    part = replace(sheet, title="", note="", panels=panels, rows=rows, heights=())
    picture = base64.b64encode(render(part.overview(), ".svg")).decode()
    key = "zoom-" + "-".join(dict.fromkeys(name for row in rows for name in row))
    return (
        f'<figure><input type="checkbox" class="zoom" id="{escape(key)}">'
        f'<label for="{escape(key)}">Enlarge</label>'
        f'<div class="pan" role="region" tabindex="0" aria-label="{escape(caption)}">'
        f'<img src="data:image/svg+xml;base64,{picture}" alt="{escape(alt)}"></div>'
        f"<figcaption>{escape(caption)}</figcaption></figure>"
    )

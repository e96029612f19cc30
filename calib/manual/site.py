"""The manual as a small site: one HTML file a page, a style, a search that needs no server."""

import json
from collections.abc import Iterable
from pathlib import PurePosixPath
from typing import Any

from calib.demo.samples import sample_logs
from calib.manual.html import PICTURES, Body, body
from calib.manual.page import INDEX, Page, contents, front
from calib.reports.html import environment, page

START = f"{INDEX}.html"
"""The file to open."""


def site() -> dict[str, bytes]:
    """Every file of the site by its path within it.

    Raises InputError where the program was installed without the sample logs, which have the
    pictures.
    """
    bodies = {one: body(one.text) for one in (front(), *contents())}
    return {
        **{f"{one.name}.html": _html(one, made).encode() for one, made in bodies.items()},
        "style.css": _filled("manual.css.j2").encode(),
        "search.js": _filled("manual.js.j2", sections=_index(bodies)).encode(),
        **_pictures(bodies.values()),
    }


def _html(one: Page, made: Body) -> str:
    pages = contents()
    at = pages.index(one) if one in pages else -1
    return page(
        "manual",
        page=one,
        body=made.html,
        sections=made.sections[1:] if one in pages and len(made.sections) > 3 else (),
        groups={other.group: [p for p in pages if p.group == other.group] for other in pages},
        before=pages[at - 1] if at > 0 else None,
        after=pages[at + 1] if at + 1 < len(pages) else None,
    )


def _filled(template: str, **values: object) -> str:
    return environment().get_template(template).render(values)


def _index(bodies: dict[Page, Body]) -> str:
    """The sections of all pages for the search, as JSON that may stand in a script."""
    entries: list[dict[str, Any]] = [
        {"page": one.title, "at": f"{one.name}.html#{part.anchor}", "head": part.title}
        | {"text": part.text}
        for one, made in bodies.items()
        if one.name != INDEX
        for part in made.sections
    ]
    return json.dumps(entries, ensure_ascii=False).replace("</", "<\\/")


def _pictures(bodies: Iterable[Body]) -> dict[str, bytes]:
    names = {PurePosixPath(path).name for made in bodies for path in made.pictures}
    folder = sample_logs() / PICTURES
    return {f"{PICTURES}/{name}": (folder / name).read_bytes() for name in sorted(names)}

"""`brake-cal manual`: the list of pages, or one page."""

import sys
from typing import TYPE_CHECKING, Annotated

import typer

from cli.console import emit, emit_json, say
from cli.grid import grid
from cli.options import Json, example

if TYPE_CHECKING:
    from rich.table import Table as Grid

    from calib.help.page import Page

EPILOG = example("brake-cal manual", "brake-cal manual ramp")


def _names() -> list[str]:
    """Every PAGE."""
    from calib.help.page import contents

    return [page.name for page in contents()]


def manual(
    page: Annotated[
        str | None,
        typer.Argument(
            metavar="PAGE",
            help="One page, or the beginning of its name; else a list.",
            autocompletion=_names,
        ),
    ] = None,
    json: Json = False,
) -> None:
    """Show the manual: the list of its pages, or one page.

    On a terminal a page is laid out; elsewhere it is the Markdown as it was written.
    """
    if page is not None:
        _show(_found(page), json)
    else:
        _list(json)


def _list(json: bool) -> None:
    from calib.help.page import contents

    if json:
        emit_json({"schema": 1, "pages": contents()})
    else:
        emit(_grid(contents()))
        say("brake-cal manual PAGE shows one")


def _grid(pages: "tuple[Page, ...]") -> "Grid":
    table = grid("page", "what it is about", fold=True)
    table.columns[0].no_wrap = True
    for page in pages:
        table.add_row(page.name, f"{page.title}: {page.about}")
    return table


def _found(asked: str) -> "Page":
    from calib.base.toml import did_you_mean
    from calib.help.page import find, plain_name

    pages = find(asked)
    if len(pages) == 1:
        return pages[0]
    names = [page.name for page in pages]
    hint = f"it may be {' or '.join(names)}" if names else ""
    hint = hint or _about(asked) or did_you_mean(plain_name(asked), _names())
    hint = hint or "'brake-cal manual' lists the pages"
    raise typer.BadParameter(f"no page {asked!r}; {hint}", param_hint="PAGE")


def _about(word: str) -> str:
    """Pages that have the word in the line on what they are about; "" if none has it."""
    from calib.help.page import contents

    names = [p.name for p in contents() if word.lower() in f"{p.title} {p.about}".lower()]
    return f"look into {' or '.join(names)}" if names else ""


def _show(page: "Page", json: bool) -> None:
    if json:
        emit_json({"schema": 1, "page": page, "text": page.text})
    elif sys.stdout.isatty():
        from calib.help.page import for_terminal
        from cli.laid_out import LaidOut

        emit(LaidOut(for_terminal(page.text), hyperlinks=False), whole=True)
    else:
        emit(page.text.rstrip("\n"))

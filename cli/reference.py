"""`brake-cal effects`, `schema`, `settings` and `manual`: what can be looked up."""

from dataclasses import fields
from typing import TYPE_CHECKING

import typer

from cli.command import Answer, command
from cli.console import Markdown, emit, emit_json, misuse, say
from cli.options import OwnEffects, argument, require_known

if TYPE_CHECKING:
    from calib.car.effects.effect import Effect
    from calib.help.page import Page


@command(
    "brake-cal effects",
    "brake-cal effects air_brake_flap --effect sample_logs/own_effect/air_brake_flap.py",
)
def effects(
    name: str | None = argument(
        "One effect; if not given, all.", "NAME", autocompletion=lambda: _catalogue()
    ),
    *,
    effect: OwnEffects,
) -> Answer:
    """List the effects that a model can have.

    With a NAME its card is printed. With --effect the file is checked, and its effect is among
    them.
    """
    from calib.show.vehicle import card, cards

    known = {**_catalogue(), **{one.name: one.effect for one in effect}}
    if name is None:
        found = [one.card for one in known.values()]
        return Answer({"effects": found}, cards(found))
    require_known(name, known, "effect ")
    return Answer({"effects": [known[name].card]}, card(known[name].card))


def _catalogue() -> "dict[str, Effect]":
    from calib.car.effects.catalogue import CATALOGUE

    return dict(CATALOGUE)


def _kinds() -> list[str]:
    from calib.help.documents import FILES, documents

    return [*FILES, *documents()]


@command("brake-cal schema vehicle", "brake-cal schema fit-json")
def schema(
    name: str | None = argument(
        "One kind of file; if not given, the list.", "NAME", autocompletion=_kinds
    ),
    *,
    json: bool = typer.Option("--json", help="Print one JSON document on stdout."),
) -> Answer:
    """Print the JSON Schema of a file or a document.

    Without a NAME it lists those that there are, in draft 2020-12. Of a file that is read it gives
    keys, units and ranges. Conditions between two values, such as a disc that fits into the wheel,
    are checked by the program only. Of a document that --json prints or a command writes it gives
    the keys of the first level.
    """
    from calib.base.record import json_schema
    from calib.help.documents import FILES, documents, section
    from calib.show.facts import Facts

    files = {name: about for name, (about, _) in FILES.items()}
    written = {name: one.title.replace("`", "") for name, one in documents().items()}
    if name is not None:
        require_known(name, _kinds(), "file ")
        emit_json(json_schema(section(name)) if name in FILES else documents()[name].schema)
    elif json:
        emit_json({"schema": 1, "files": files, "documents": written})
    else:
        emit(Facts(rows=[*files.items(), *written.items()]))
    return Answer({})


KEYS = {
    "station": "station.name",
    "golden": "station.golden",
    "export": "station.export",
    "public_key": "keys.public",
}
"""Where a setting has another name in the file."""


@command("brake-cal settings", "brake-cal settings --json")
def settings() -> Answer:
    """Show each setting, its value and where it comes from.

    The file is brake-cal.toml in this folder or the nearest one above that has it; the variable
    BRAKE_CAL_SETTINGS names another one, or none if it is empty. Its paths lead from its folder. An
    option on the command line wins over it. Which command takes what:

    \b
    store    every command with --store
    map      every command with --map but `map`
    vehicle  fit, station, simulate, diagnose, repeatability, batch and watch fit;
             not validate and plot: there the vehicle is that of the table
    limits   station, validate, batch and watch validate
    station  station: name is --station, golden is --golden, export is --export
    keys.public, require_signed, by   who signs and changes the state of tables
    """  # noqa: D301
    from calib.base.settings import NAME, STORE, VARIABLE
    from calib.base.settings_file import find_project
    from calib.show.facts import Facts, Table
    from calib.store.state import user

    found = find_project()
    if found.file is None:
        searched = f"no {NAME} in {', '.join(map(str, found.searched))}"
        say(searched if found.searched else f"no settings file: {VARIABLE} is empty")
    rows: list[tuple[str, object, str]] = []
    for field in fields(found.settings):
        key, value = KEYS.get(field.name, field.name), getattr(found.settings, field.name)
        if value is not None:
            rows.append((key, value, f"file:{found.file}"))
        elif field.name == "by":
            rows.append((key, user(), "environment"))
        else:
            built_in = {"store": STORE, "require_signed": False}.get(field.name)
            rows.append((key, built_in, "built-in"))
    document = {
        "file": found.file,
        "searched": found.searched,
        "settings": {key: {"value": value, "source": source} for key, value, source in rows},
    }
    cells = [(key, _written(value), source) for key, value, source in rows]
    return Answer(document, Facts(tables=[Table(("setting", "value", "from"), cells)]))


def _written(value: object) -> str:
    if isinstance(value, tuple):
        return ", ".join(value) or "none"
    return str(value).lower() if value is None or isinstance(value, bool) else str(value)


def _pages() -> list[str]:
    from calib.help.page import contents

    return [page.name for page in contents()]


@command("brake-cal manual", "brake-cal manual ramp")
def manual(
    page: str | None = argument(
        "One page, or the beginning of its name; else a list.", "PAGE", autocompletion=_pages
    ),
) -> Answer:
    """Show the manual: the list of its pages, or one page.

    On a terminal a page is laid out; elsewhere it is the Markdown as it was written.
    """
    from calib.help.page import contents, for_terminal
    from calib.show.facts import Facts, Table

    if page is None:
        say("brake-cal manual PAGE shows one")
        rows = [(one.name, f"{one.title}: {one.about}") for one in contents()]
        return Answer(
            {"pages": contents()}, Facts(tables=[Table(("page", "what it is about"), rows)])
        )
    found = _page(page)
    text = found.text.rstrip("\n")
    return Answer({"page": found, "text": found.text}, Markdown(for_terminal(text), text))


def _page(asked: str) -> "Page":
    """The page of a name or its beginning; else a refusal with those that may be meant."""
    from calib.base.toml import did_you_mean
    from calib.help.page import contents, find, plain_name

    pages = find(asked)
    if len(pages) == 1:
        return pages[0]
    about = [p.name for p in contents() if asked.lower() in f"{p.title} {p.about}".lower()]
    hint = (
        (f"it may be {' or '.join(page.name for page in pages)}" if pages else "")
        or (f"look into {' or '.join(about)}" if about else "")
        or did_you_mean(plain_name(asked), _pages())
        or "'brake-cal manual' lists the pages"
    )
    raise misuse(f"no page {asked!r}; {hint}", "PAGE")

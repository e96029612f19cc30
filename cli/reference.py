"""`brake-cal effects`, `schema`, `settings` and `manual`: what can be looked up."""

from typing import TYPE_CHECKING

from cli.command import Answer, command
from cli.console import PageText, emit_json, say
from cli.options import OwnEffects, argument, require_known

if TYPE_CHECKING:
    from calib.car.effects.effect import Effect

_KINDS = "calib.help.documents:kinds"


@command(
    "brake-cal effects",
    "brake-cal effects air_brake_flap --effect sample_logs/own_effect/air_brake_flap.py",
)
def effects(
    name: str | None = argument(
        "One effect; if not given, all.", "NAME", autocompletion=lambda: [*_catalogue()]
    ),
    *,
    effect: OwnEffects,
) -> Answer:
    """List the effects that a model can have.

    With a NAME its card is printed; with --effect a file of your own is checked.
    """
    from calib.show.vehicle import card, cards

    catalogue = {**_catalogue(), **{one.name: one.effect for one in effect}}
    if name is None:
        chosen = [one.card for one in catalogue.values()]
        return Answer({"effects": chosen}, cards(chosen))
    require_known(name, catalogue, "effect ")
    return Answer({"effects": [catalogue[name].card]}, card(catalogue[name].card))


def _catalogue() -> "dict[str, Effect]":
    from calib.car.effects.catalogue import CATALOGUE

    return dict(CATALOGUE)


@command("brake-cal schema vehicle", "brake-cal schema fit-json")
def schema(
    name: str | None = argument("A kind; else the list.", "NAME", names=_KINDS),
) -> Answer:
    """Print the JSON Schema of a file or a document.

    Of a file that is read it gives keys, units and ranges, of a document that --json prints or a
    command writes the keys of the first level, in draft 2020-12.
    """
    from calib.help.documents import FILES, documents, schema_of
    from calib.show.facts import Facts

    if name is not None:
        emit_json(schema_of(name))
        return Answer({})
    written = {name: one.title for name, one in documents().items()}
    facts = Facts(rows=[*FILES.items(), *written.items()])
    return Answer({"files": FILES, "documents": written}, facts)


@command("brake-cal settings")
def settings() -> Answer:
    """Show each setting, its value and where it comes from.

    The file is brake-cal.toml in this folder or the nearest one above that has it; the variable
    BRAKE_CAL_SETTINGS names another one, or none if it is empty. An option wins over it.
    """
    from calib.base.names import SETTINGS_FILE, SETTINGS_VARIABLE, STORE
    from calib.base.settings_file import find_project
    from calib.show.facts import Facts, Table
    from calib.store.state import user

    project = find_project()
    if project.file is None:
        folders = f"no {SETTINGS_FILE} in {', '.join(map(str, project.folders))}"
        say(folders if project.folders else f"no settings file: {SETTINGS_VARIABLE} is empty")
    usual = {"store": STORE, "require_signed": False, "by": user()}
    settings: dict[str, dict[str, object]] = {}
    for key, value in project.settings.items():
        source = "environment" if key == "by" else "built-in"
        settings[key] = {
            "value": usual.get(key) if value is None else value,
            "source": source if value is None else f"file:{project.file}",
        }
    cells = [(k, _written(one["value"]), str(one["source"])) for k, one in settings.items()]
    document = {"file": project.file, "searched": project.folders, "settings": settings}
    return Answer(document, Facts(tables=[Table(("setting", "value", "from"), cells)]))


def _written(value: object) -> str:
    if isinstance(value, list):
        return ", ".join(value) or "none"
    return str(value).lower() if value is None or isinstance(value, bool) else str(value)


def _topics() -> list[str]:
    from calib.help.explain import codes
    from calib.help.page import contents

    return [*contents(), *codes()]


@command("brake-cal manual ramp", "brake-cal manual a_x_scale")
def manual(
    topic: str | None = argument(
        "A page, or a code; else a list of the pages.", "PAGE|CODE", names=f"{__name__}:_topics"
    ),
) -> Answer:
    """Show the pages of the manual, one of them, or what a code means.

    Codes are those of warnings and metrics in JSON documents and limits files, and the reasons of
    an ECU for no valid answer. On a terminal a page is shown by the pager that PAGER names; a pipe
    gets its Markdown.
    """
    from calib.help.explain import explained
    from calib.help.page import contents
    from calib.show.facts import Facts, Table

    pages = contents()
    if topic is None:
        rows = [(one.name, f"{one.title}: {one.about}") for one in pages.values()]
        say("brake-cal manual PAGE shows one; brake-cal manual CODE explains a warning")
        facts = Facts(tables=[Table(("page", "what it is about"), rows)])
        return Answer({"pages": list(pages.values())}, facts)
    if page := pages.get(topic):
        return Answer({"page": page, "text": page.text}, PageText(page.text.rstrip("\n")))
    facts = explained(topic)
    return Answer({"code": topic, "text": [": ".join(row) for row in facts.rows]}, facts)

"""`brake-cal effects`, `schema`, `settings` and `manual`: look something up."""

from cli.command import Answer, command
from cli.console import PageText, print_json, say
from cli.options import OwnEffects, argument, names_at, require_known

_EFFECTS = "calib.car.effects.catalogue:CATALOGUE"
_KINDS = "calib.help.documents:kinds"


@command(
    "brake-cal effects",
    "brake-cal effects air_brake_flap --effect sample_logs/own_effect/air_brake_flap.py",
)
def effects(
    name: str | None = argument(
        "Effect, else all.", "NAME", autocompletion=lambda: names_at(_EFFECTS)
    ),
    *,
    effect: OwnEffects,
) -> Answer:
    """List the effects that a model can have.

    NAME prints the card of one effect. --effect checks a file of your own.
    """
    from calib.car.effects.catalogue import CATALOGUE
    from calib.show.vehicle import card, cards

    catalogue = dict(CATALOGUE) | {added.name: added.effect for added in effect}
    if name is None:
        all_cards = [known.card for known in catalogue.values()]
        return Answer({"effects": all_cards}, cards(all_cards))
    chosen = catalogue[require_known(name, catalogue, "effect", "NAME")].card
    return Answer({"effects": [chosen]}, card(chosen))


@command("brake-cal schema vehicle", "brake-cal schema fit-json")
def schema(
    name: str | None = argument("Kind of file or document, else the list.", "NAME", names=_KINDS),
) -> Answer:
    """Print the JSON Schema of a file or a document.

    The schema of a file that is read has keys, units and ranges. That of a document that a command
    prints or writes has the keys of the first level. All are of draft 2020-12.
    """
    from calib.help.documents import FILES, documents, schema_of
    from calib.show.facts import Facts

    if name is not None:
        print_json(schema_of(name))
        return Answer({})
    titles = {kind: document.title for kind, document in documents().items()}
    facts = Facts(rows=[*FILES.items(), *titles.items()])
    return Answer({"files": FILES, "documents": titles}, facts)


@command("brake-cal settings")
def settings() -> Answer:
    """Show each setting, its value and where it comes from.

    The file is brake-cal.toml in this folder or the nearest one above. The variable
    BRAKE_CAL_SETTINGS names another file, or none if it is empty. An option wins over a setting.
    """
    from calib.base.names import SETTINGS_FILE, SETTINGS_VARIABLE, STORE
    from calib.base.settings_file import find_project
    from calib.show.facts import Facts, Table
    from calib.store.state import user

    project = find_project()
    if project.file is None:
        message = f"no settings file: {SETTINGS_VARIABLE} is empty"
        if project.folders:
            message = f"no {SETTINGS_FILE} in {', '.join(map(str, project.folders))}"
        say(message)
    built_in = {"store": STORE, "require_signed": False, "by": user()}
    settings: dict[str, dict[str, object]] = {}
    rows = []
    for key, value in project.settings.items():
        source = f"file:{project.file}"
        if value is None:
            value = built_in.get(key)
            source = "environment" if key == "by" else "built-in"
        settings[key] = {"value": value, "source": source}
        rows.append((key, _written(value), source))
    document = {"file": project.file, "searched": project.folders, "settings": settings}
    return Answer(document, Facts(tables=[Table(("setting", "value", "from"), rows)]))


def _written(value: object) -> str:
    if isinstance(value, list):
        return ", ".join(value) or "none"
    if value is None or isinstance(value, bool):
        return str(value).lower()
    return str(value)


def _topics() -> list[str]:
    from calib.help.explain import codes
    from calib.help.page import contents

    return [*contents(), *codes()]


@command("brake-cal manual ramp", "brake-cal manual a_x_scale")
def manual(
    topic: str | None = argument(
        "Page or code, else the list of the pages.", "PAGE|CODE", names="cli.reference:_topics"
    ),
) -> Answer:
    """Show the pages of the manual, one of them, or what a code means.

    A code is that of a warning or a metric in JSON documents and limits files, or the reason why an
    answer of an ECU is not valid; `brake-cal explain CODE` is the same command. On a terminal the
    pager that PAGER names shows the page; a pipe gets its Markdown.
    """
    from calib.help.explain import explained
    from calib.help.page import contents
    from calib.show.facts import Facts, Table

    pages = contents()
    if topic is None:
        rows = [(page.name, f"{page.title}: {page.about}") for page in pages.values()]
        say("brake-cal manual PAGE shows one; brake-cal manual CODE explains a warning")
        facts = Facts(tables=[Table(("page", "what it is about"), rows)])
        return Answer({"pages": list(pages.values())}, facts)
    if topic in pages:
        page = pages[topic]
        return Answer({"page": page, "text": page.text}, PageText(page.text.rstrip("\n")))
    facts = explained(topic)
    return Answer({"code": topic, "text": [": ".join(row) for row in facts.rows]}, facts)

"""The pages: contents, links, and that commands, columns, limits, codes and effects are theirs."""

import re
from dataclasses import fields
from io import StringIO
from pathlib import Path

import pytest
from rich.cells import cell_len
from rich.console import Console
from rich.markdown import Markdown

from calib.base.warning import UNITS
from calib.car.effects.catalogue import CATALOGUE
from calib.estimation.estimator import COLUMNS
from calib.estimation.limits import DEFAULTS
from calib.estimation.online import ANSWERS, CHANNELS
from calib.help.explain import explained
from calib.help.page import FOLDER, contents, for_terminal
from calib.table.maps import LevelMap, PadMap
from tests.support.gallery import PAGE, PICTURES
from tests.support.manual import PAGES
from tests.test_layers import ROOMS

README, CONTRIBUTING = (FOLDER.parents[1] / f"{name}.md" for name in ("README", "CONTRIBUTING"))
LINK = re.compile(r"\[[^\]]*\]\(([^)\s]+)\)")


def titles(page: Path) -> list[str]:
    """The headings of a page; a block of code has none."""
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    return re.findall(r"^#+ (.*)$", text, flags=re.MULTILINE)


def anchor(title: str) -> str:
    """The anchor of a heading, as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


def test_every_page_is_listed_once_under_its_own_title():
    assert sorted([*contents(), "index"]) == sorted(page.stem for page in PAGES)
    for page in contents().values():
        first, *_ = titles(FOLDER / f"{page.name}.md")
        assert page.title == first
        assert page.group
        assert page.about.endswith(".")


@pytest.mark.parametrize("page", [*PAGES, README, CONTRIBUTING], ids=lambda page: page.stem)
def test_links_lead_to_files_and_headings_that_are_there(page):
    for target in LINK.findall(page.read_text()):
        if target.startswith("https://"):
            continue
        path, _, heading = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        assert file.is_file(), target
        if heading:
            assert heading in {anchor(title) for title in titles(file)}, target


@pytest.mark.parametrize("width", [30, 80, 120])
def test_a_page_fits_a_terminal_without_links_and_equations_of_markdown(width):
    console = Console(width=width, file=StringIO(), force_terminal=False)
    for page in contents().values():
        console.print(Markdown(for_terminal(page.text)))
    lines = console.file.getvalue().splitlines()
    assert max(map(cell_len, lines)) <= width
    assert not [line for line in lines if re.search(r"\]\(|\$\$|\\(frac|tag|mathrm|\w*eta)", line)]


def test_what_contributing_names_is_there():
    root, text = CONTRIBUTING.parent, CONTRIBUTING.read_text()
    names = [x for x in re.findall(r"`([^` ]+)`", text) if "/" in x or x.endswith(".toml")]
    assert [x for x in names if not (root / x).exists()] == []
    for name, file in re.findall(r"`(\w+)` (?:in|of) `(\w+/\S+\.py)`", text):
        assert re.search(rf"\b{name}\b", (root / file).read_text()), name
    for module in re.findall(r"`python -m ([\w.]+)`", text):
        assert (root / module.replace(".", "/")).with_suffix(".py").is_file()
    house = text.partition("```text\n")[2].partition("```")[0]
    floors = [row.split() for row in ROOMS.strip().splitlines()]
    assert [line[:27].split() for line in house.splitlines()] == floors


VALIDATION = (FOLDER / "validation.md").read_text()


def test_the_default_limits_are_those_of_the_program():
    rows = dict(re.findall(r"^\| `(\w+)`.*\| ([^|]+) \|$", VALIDATION, flags=re.MULTILINE))
    for limit in DEFAULTS:
        axle = 1 if limit.figure.endswith("_r") else 0
        row = rows[re.sub("_(r|level)$", "_f", limit.figure)]
        numbers = [float(number) for number in re.findall(r"\d\.\d+", row)]
        bound = next(x for x in (limit.low, limit.high, limit.warn_low) if x is not None)
        assert numbers[axle] == bound, limit.figure


def test_every_code_is_explained():
    assert len(UNITS) > 50
    assert [code for code in UNITS if not explained(code).rows] == []


def test_every_effect_is_in_the_gallery_with_the_words_of_its_card():
    text = PAGE.read_text(encoding="utf-8")
    cards = {name: effect.card for name, effect in CATALOGUE.items()}
    assert [name for name, card in cards.items() if card.looks_like[1:] not in text] == []


def test_the_gallery_has_all_its_pictures_and_they_are_small():
    text, pictures = PAGE.read_text(encoding="utf-8"), sorted(PICTURES.iterdir())
    names = sorted(name for name in CATALOGUE if f"/{name}.png" in text)
    assert [picture.stem for picture in pictures] == names
    assert sum(picture.stat().st_size for picture in pictures) < 400e3


GLOSSARY = (FOLDER / "glossary.md").read_text()
END = re.compile(r"^ecu_|_(lower|upper)$|_([fr][lr]?|sum)(_(lower|upper))?$")
"""What stands before or behind a name for another axle, wheel or bound, or for the ECU."""


def test_columns_of_results_of_maps_and_of_the_ecu_are_in_the_glossary():
    maps = {column.name for kind in (PadMap, LevelMap) for column in fields(kind)}
    in_glossary = {re.sub(END, "", name) for name in re.findall(r"`(\w+)`", GLOSSARY)}
    names = {re.sub(END, "", name) for name in {*COLUMNS, *CHANNELS, *ANSWERS, *maps}}
    assert names - in_glossary == set()

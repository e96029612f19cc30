"""The contents of the manual, and every link and anchor in it and in the README."""

import io
import re
from pathlib import Path

import pytest
from rich.console import Console
from rich.markdown import Markdown

from calib.help.page import FOLDER, contents, find, for_terminal, front
from tests.support.manual import PAGES

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
    assert sorted([page.name for page in contents()]) == sorted(
        page.stem for page in PAGES if page.stem != front().name
    )
    for page in contents():
        first, *_ = titles(FOLDER / f"{page.name}.md")
        assert page.title == first
        assert page.group
        assert page.about.endswith(".")


@pytest.mark.parametrize("page", [*PAGES, README, CONTRIBUTING], ids=lambda page: page.stem)
def test_links_lead_to_files_and_headings_that_are_there(page):
    for target in LINK.findall(page.read_text()):
        if target.startswith("https://"):
            continue
        path, _, at = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        assert file.is_file(), target
        if at:
            assert at in {anchor(title) for title in titles(file)}, target


def test_the_readme_is_short_and_leads_to_the_contents():
    text = README.read_text()
    assert len(text.splitlines()) <= 125
    assert "(calib/manual/index.md)" in text


@pytest.mark.parametrize("page", PAGES, ids=lambda page: page.stem)
def test_a_page_begins_with_its_only_title(page):
    text = re.sub(r"^```.*?^```", "", page.read_text(), flags=re.MULTILINE | re.DOTALL)
    assert re.findall(r"^# ", text, flags=re.MULTILINE) == ["# "]
    assert text.startswith("# ")


@pytest.mark.parametrize(
    ("asked", "names"),
    [
        ("ramp", ["ramp"]),
        ("Vehicle-File.md", ["vehicle_file"]),
        (" vehicle FILE ", ["vehicle_file"]),
        ("veh", ["vehicle_file"]),
        ("v", ["vehicle_file", "validation"]),
        ("index", ["index"]),
        ("", []),
    ],
)
def test_a_page_is_found_by_its_name_or_the_beginning_of_it(asked, names):
    assert [page.name for page in find(asked)] == names


def test_comments_are_for_authors_only():
    for page in contents():
        assert "<!--" not in page.text, page.name


def test_a_terminal_is_told_the_page_that_a_link_leads_to():
    text = "see [the line](line.md#limits), [minisign](https://a.b) ![a table](../x.png)"
    assert for_terminal(text) == (
        "see the line (page `line`), [minisign](https://a.b) *(picture: a table)*"
    )


@pytest.mark.parametrize("page", contents(), ids=lambda page: page.name)
def test_a_page_fits_a_terminal_of_80_columns(page):
    shown = io.StringIO()
    Console(file=shown, width=80).print(Markdown(for_terminal(page.text), hyperlinks=False))
    lines = shown.getvalue().splitlines()
    assert page.title in shown.getvalue()
    assert max(len(line) for line in lines) <= 80

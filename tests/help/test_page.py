"""The contents of the manual, and every link and anchor in it and in the README."""

import re
from pathlib import Path

import pytest

from calib.help.page import FOLDER, contents
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
        path, _, at = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        assert file.is_file(), target
        if at:
            assert at in {anchor(title) for title in titles(file)}, target

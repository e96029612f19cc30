"""The pages of the manual and their order, which `index.md` has."""

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "manual"
_INDEX = "index"
"""Name of the page that lists the others."""

_GROUP = re.compile(r"## (.+)")
_LINE = re.compile(r"- \[(.+)\]\((\w+)\.md\): (.+)")
_COMMENT = re.compile(r"^<!--.*?-->\n\n?", re.DOTALL | re.MULTILINE)


@dataclass(frozen=True)
class Page:
    """One page: ``name`` of its file, ``title``, one line ``about`` it, ``group`` of the contents.

    The text is read when it is asked for.
    """

    name: str
    title: str
    about: str
    group: str

    @property
    def text(self) -> str:
        """The page as Markdown, without comments."""
        return _COMMENT.sub("", (FOLDER / f"{self.name}.md").read_text(encoding="utf-8"))


@cache
def contents() -> tuple[Page, ...]:
    """All pages in the order in which they are read, without the list itself."""
    pages, group = [], ""
    for line in front().text.splitlines():
        if found := _GROUP.fullmatch(line):
            group = found[1]
        elif found := _LINE.fullmatch(line):
            title, name, about = found.groups()
            pages.append(Page(name, title, about, group))
    return tuple(pages)


@cache
def front() -> Page:
    """The page that lists the others."""
    return Page(_INDEX, "Contents", "all pages by subject.", "")


def find(asked: str) -> list[Page]:
    """The page of a name, else all pages whose names begin like it.

    Case, an ending ``.md``, and the difference of ``-``, ``_`` and blank do not count.
    """
    name = plain_name(asked)
    exact = [one for one in (front(), *contents()) if one.name == name]
    return exact or [one for one in contents() if name and one.name.startswith(name)]


def plain_name(asked: str) -> str:
    """A name as files have it: ``vehicle_file`` of ``Vehicle-File.md``."""
    return re.sub(r"[\s-]+", "_", asked.strip().lower().removesuffix(".md"))


def for_terminal(text: str) -> str:
    """Markdown for a terminal, where nobody can follow a link: it names page and picture."""
    text = re.sub(r"!\[([^]]*)\]\([^)]*\)", r"*(picture: \1)*", text)
    return re.sub(r"\[([^]]+)\]\((\w+)\.md[^)]*\)", r"\1 (page `\2`)", text)

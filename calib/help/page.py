"""The pages of the manual and their order, which `index.md` has."""

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

FOLDER = Path(__file__).parents[1] / "manual"

_ROW = re.compile(r"## (?P<group>.+)|- \[(?P<title>.+)\]\((?P<name>\w+)\.md\): (?P<about>.+)")
_COMMENT = re.compile(r"^<!--.*?-->\n\n?", re.DOTALL | re.MULTILINE)


@dataclass(frozen=True)
class _Page:
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
def contents() -> dict[str, _Page]:
    """All pages by name, in the order in which they are read, without the list itself."""
    pages, group = {}, ""
    for line in (FOLDER / "index.md").read_text(encoding="utf-8").splitlines():
        if row := _ROW.fullmatch(line):
            group = row["group"] or group
            if row["name"]:
                pages[row["name"]] = _Page(row["name"], row["title"], row["about"], group)
    return pages

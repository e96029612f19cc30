"""The pages of the manual in the order of `index.md`, and how a terminal shows a page.

page.md --for_terminal--> Markdown without links and LaTeX --rich--> lines
"""

import re
from dataclasses import dataclass
from functools import cache
from pathlib import Path

from calib.help.samples import sample_logs

FOLDER = Path(__file__).parents[1] / "manual"
"""Folder of the pages."""
_ROW = re.compile(r"## (?P<group>.+)|- \[(?P<title>.+)\]\((?P<name>\w+)\.md\): (?P<about>.+)")
_COMMENT = re.compile(r"^<!--.*?-->\n\n?", re.DOTALL | re.MULTILINE)
_PIECE = re.compile(
    r"^(?P<code>```.*?^```)$|^\$\$\n(?P<equation>.*?)\n\$\$$|\$(?P<symbol>[^$\n]+)\$"
    r"|!\[(?P<caption>[^]]*)\]\(\S*?sample_logs/(?P<picture>\S+)\)"
    r"|\[(?P<words>[^]]*)\]\((?P<page>\w+)\.md\S*?\)|\[(?P<here>[^]]*)\]\(#\S*\)",
    re.DOTALL | re.MULTILINE,
)
"""Parts of a page that a terminal shows in another way; code is matched to keep it as it is."""
_OF_LATEX = (
    (r"\\mathrm\{(\w+)\}", r"\1"),
    (r"([_^])\{(\w+)\}", r"\1\2"),
    (r"([_^])\{([^{}]*)\}", r"\1(\2)"),
    (r"\\(dot|hat) *(\\[A-Za-z]+|\w)", r"\2\\\1"),
    (r"\\tag\{([^{}]*)\}", r"      (\1)"),
    (r"\\frac\{([^{}]*)\}\{([^{}]*)\}", r"(\1)/(\2)"),
    (r"(?<![\w)])\(([\w\\]+)\)(?=/)|(?<=/)\(([\w\\]+)\)", r"\1\2"),  # (a)/(b) to a/b
    (r"\\leq", "<="),
    (r"\\approx", "~"),
    (r"\\to\b", "->"),
    (r"\\quad", "  "),
    (r"\\(left|right)\b", ""),
    (r"\\([A-Za-z]+)", r"\1"),
)
"""Patterns of LaTeX and what replaces them, in this order: innermost parts first."""


@dataclass(frozen=True)
class _Page:
    """A page of the manual, as `index.md` lists it."""

    name: str  # of its file
    title: str
    about: str  # a sentence
    group: str  # heading in `index.md`

    @property
    def text(self) -> str:
        """The page as Markdown, without comments; the file is read at each call."""
        return _COMMENT.sub("", (FOLDER / f"{self.name}.md").read_text(encoding="utf-8"))


@cache
def contents() -> dict[str, _Page]:
    """Return the pages by name, in the order of `index.md`."""
    pages, group = {}, ""
    for line in (FOLDER / "index.md").read_text(encoding="utf-8").splitlines():
        row = _ROW.fullmatch(line)
        if row and row["group"]:
            group = row["group"]
        elif row:
            pages[row["name"]] = _Page(row["name"], row["title"], row["about"], group)
    return pages


def for_terminal(text: str) -> str:
    """Return a page with links as commands, pictures as paths, equations without LaTeX.

    >>> for_terminal("$F_{zf}$ of [a ramp](ramp.md#the-drive)")
    'F_zf of a ramp (`brake-cal manual ramp`)'
    """
    return _PIECE.sub(_in_terminal, text)


def _in_terminal(piece: re.Match[str]) -> str:
    """Return what a terminal shows in place of a `_PIECE`."""
    if piece["equation"]:
        return "".join(f"\n    {_plain(line)}" for line in piece["equation"].splitlines()) + "\n"
    if piece["symbol"]:
        return _plain(piece["symbol"])
    if piece["picture"]:
        return f"Picture: {piece['caption']}, `{sample_logs() / piece['picture']}`"
    if piece["page"]:
        return f"{piece['words']} (`brake-cal manual {piece['page']}`)"
    return piece["here"] or piece[0]  # words of a link in the page, or code


def _plain(latex: str) -> str:
    r"""Return an equation without LaTeX.

    >>> _plain(r"\eta = \frac{1 - \lambda_r}{1 - \lambda_f} \tag{22}")
    'eta = (1 - lambda_r)/(1 - lambda_f)       (22)'
    """
    for pattern, plain in _OF_LATEX:
        latex = re.sub(pattern, plain, latex)
    return latex

"""Markdown of a page as HTML: headings with anchors, links between the pages, tables that scroll.

The tokens of markdown-it are changed before they are written: anchors, links, tables.
"""

import re
from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import PurePosixPath
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from markdown_it import MarkdownIt
    from markdown_it.token import Token

PICTURES = "figures"
"""Folder of the pictures in the site."""

_PAGE = re.compile(r"(\w+)\.md(#.*)?")


@dataclass(frozen=True)
class PageSection:
    """A heading and what stands below it up to the next one: ``anchor``, ``title``, plain text."""

    anchor: str
    title: str
    text: str


@dataclass(frozen=True)
class Body:
    """A page as HTML, its sections, and the paths of its pictures as the Markdown has them."""

    html: str
    sections: tuple[PageSection, ...]
    pictures: tuple[str, ...]


def body(text: str) -> Body:
    """The Markdown ``text`` of one page as HTML."""
    tokens = _parser().parse(text)
    inline = [part for token in tokens for part in token.children or ()]
    _set_anchors(tokens)
    _mend_links(inline)
    pictures = _mend_pictures(inline)
    html = _parser().renderer.render(_without_empty_heads(tokens), _parser().options, {})
    return Body(html, tuple(_sections(tokens)), pictures)


def anchor(title: str) -> str:
    """The anchor of a heading, as GitHub makes it."""
    return re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-")


@cache
def _parser() -> "MarkdownIt":
    from markdown_it import MarkdownIt

    parser = MarkdownIt("commonmark", {"html": False}).enable("table")
    for kind, rule in RULES.items():
        parser.add_render_rule(kind, rule)
    return parser


def _boxed(before: str, after: str) -> Callable[..., str]:
    """A rule of the renderer that puts text around an element."""

    def rule(renderer, tokens, index, options, env):  # type: ignore[no-untyped-def]
        return before + renderer.renderToken(tokens, index, options, env) + after

    return rule


def _code(renderer, tokens, index, options, env):  # type: ignore[no-untyped-def]
    """A block of code; it can be scrolled with the keyboard."""
    from html import escape

    return f'<pre tabindex="0"><code>{escape(tokens[index].content)}</code></pre>\n'


RULES: dict[str, Callable[..., str]] = {
    "table_open": _boxed('<div class="wide" role="group" aria-label="Table" tabindex="0">', ""),
    "table_close": _boxed("", "</div>\n"),
    "fence": _code,
    "code_block": _code,
}
"""What is written otherwise than markdown-it does."""


def _set_anchors(tokens: "Sequence[Token]") -> None:
    """Give every heading its anchor; the second one of a name ends with ``-1``, as on GitHub."""
    seen: dict[str, int] = {}
    for token, inside in pairwise(tokens):
        if token.type == "heading_open":
            name = anchor(_plain(inside))
            count = seen[name] = seen.get(name, -1) + 1
            token.attrs["id"] = f"{name}-{count}" if count else name


def _mend_links(inline: "Iterable[Token]") -> None:
    """Lead links between the pages to the HTML files."""
    for token in inline:
        if token.type == "link_open" and (found := _PAGE.fullmatch(str(token.attrs["href"]))):
            token.attrs["href"] = f"{found[1]}.html{found[2] or ''}"


def _mend_pictures(inline: "Iterable[Token]") -> tuple[str, ...]:
    """Lead pictures to the folder of the site; return where they are."""
    there = []
    for token in inline:
        if token.type == "image":
            there.append(str(token.attrs["src"]))
            token.attrs["src"] = f"{PICTURES}/{PurePosixPath(there[-1]).name}"
    return tuple(there)


def _without_empty_heads(tokens: "Sequence[Token]") -> "list[Token]":
    """The tokens with plain cells where a table has no words in its head."""
    for token, inside in pairwise(tokens):
        if token.type == "th_open" and not inside.content:
            token.tag = "td"
        elif token.type == "th_open":
            token.attrs["scope"] = "col"
    for before, token in zip(tokens, tokens[2:], strict=False):
        if token.type == "th_close":
            token.tag = before.tag
    return list(tokens)


def _sections(tokens: "Sequence[Token]") -> Iterable[PageSection]:
    """The sections of a page, of its headings."""
    at = [i for i, token in enumerate(tokens) if token.type == "heading_open"]
    for start, end in zip(at, [*at[1:], len(tokens)], strict=True):
        words = (_plain(token) for token in tokens[start + 3 : end])
        text = re.sub(r"\s+", " ", " ".join(filter(None, words)))
        yield PageSection(str(tokens[start].attrs["id"]), _plain(tokens[start + 1]), text)


def _plain(token: "Token") -> str:
    """The words of a token."""
    if token.children is None:
        return token.content
    ends = ("softbreak", "hardbreak")
    return "".join(" " if part.type in ends else part.content for part in token.children)

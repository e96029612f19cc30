"""Facts as lines and grids of a terminal, which rich draws."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from itertools import zip_longest
from textwrap import wrap

from rich.console import Console, ConsoleOptions, JustifyMethod, RenderableType, RenderResult
from rich.table import Table as Grid
from rich.text import Text

from calib.base.errors import printable
from calib.show.facts import FAILED, PASSED, UNJUDGED, WARNING, Facts, Row, Table
from calib.show.numbers import unbroken

_NARROWEST = 20
"""Smallest width of a text beside its name [letters]."""
_STYLES = {FAILED: "red", WARNING: "yellow", PASSED: "green", UNJUDGED: "dim", "": ""}


def drawn(facts: Facts, *, quiet: bool = False, details: bool = False) -> Iterator[RenderableType]:
    """Yield texts and grids in their order in print.

    The parts are ``details``, printed before the answer, or the answer of facts that have nothing
    else. If there is a verdict, ``quiet`` prints its line alone. A plain string is a command to
    copy, and is never cut into lines.
    """
    facts = _texts(facts)
    has_answer = replace(facts, parts=()).filled
    for part in facts.parts if details or not has_answer else ():
        if part.title:
            yield Text(printable(part.title), style="bold")
        yield from drawn(part, details=details)
        if has_answer or part is not facts.parts[-1]:
            yield ""
    if text := facts.verdict_line:
        yield _Paragraph(text, f"bold {_STYLES[facts.verdict]}".strip())
        if quiet:
            return
    for table in facts.tables:
        if table.rows and table.caption:
            yield Text(printable(table.caption))
        if table.rows:
            yield _Grid(table)
    if rows := [*facts.numbers, *facts.rows]:
        yield _Terms(rows)
    yield from map(_Paragraph, facts.notes)
    if facts.next:
        yield f"Next: {facts.next}"


def _texts(facts: Facts) -> Facts:
    """Return the facts without pictures, warnings and empty parts."""
    parts = [part for part in map(_texts, facts.parts) if part.filled]
    return replace(facts, pictures=(), warnings=(), parts=parts)


class _Paragraph:
    """A text in lines, in which a number and its unit stay on one line."""

    def __init__(self, text: str, style: str = "") -> None:
        self.text, self.style = unbroken(printable(text)), style

    def __rich_console__(self, _: Console, options: ConsoleOptions) -> RenderResult:
        lines = [self.text] if options.no_wrap else wrap(self.text, options.max_width)
        yield from (Text(line, style=self.style) for line in lines)


class _Terms:
    """Names and their texts side by side."""

    def __init__(self, rows: Sequence[Row]) -> None:
        self.rows = [(printable(name), unbroken(printable(text))) for name, text in rows]
        self.indent = max(len(name) for name, _ in rows) + 2

    def __rich_console__(self, _: Console, options: ConsoleOptions) -> RenderResult:
        width = max(options.max_width - self.indent, _NARROWEST)
        for name, text in self.rows:
            lines = [text] if options.no_wrap else wrap(text, width)
            for head, line in zip_longest([name], lines or [""], fillvalue=""):
                yield Text(f"{head:<{self.indent}}{line}".rstrip())


def _longest_word(texts: Iterable[str]) -> int:
    """Return the length of the longest word; a no-break space does not end a word."""
    return max(len(word) for text in texts for word in text.split(" "))


class _Grid:
    """A table as a grid, or as a block of lines for each row where the grid is too wide.

    ``least`` is the width of the longest word or number of each column.
    """

    def __init__(self, table: Table) -> None:
        rows = [[unbroken(cell) for cell in row] for row in table.rows]
        self.table = replace(table, heads=[unbroken(head) for head in table.heads], rows=rows)
        self.least = [
            max(_longest_word([head]), max(map(len, cells)) if numeric else _longest_word(cells))
            for head, numeric, *cells in zip(self.table.heads, table.numeric, *rows, strict=True)
        ]

    def __rich_console__(self, _: Console, options: ConsoleOptions) -> RenderResult:
        fits = sum(self.least) + 2 * (len(self.least) - 1) <= options.max_width
        yield from [self._grid()] if fits else self._blocks()

    def _style(self, row: int) -> str:
        return _STYLES[self.table.verdicts[row]] if self.table.verdicts else ""

    def _grid(self) -> Grid:
        grid = Grid(box=None, header_style="bold", pad_edge=False)
        table = self.table
        columns = zip(table.heads, table.numeric, self.least, *table.rows, strict=True)
        for head, numeric, least, *cells in columns:
            # rich narrows other columns first
            no_wrap = numeric or max(map(len, (head, *cells))) <= least
            justify: JustifyMethod = "right" if numeric else "left"
            title = "\n".join(wrap(head, least)) if numeric else head
            grid.add_column(title, justify=justify, no_wrap=no_wrap, min_width=least)
        for i, row in enumerate(table.rows):
            grid.add_row(*row, style=self._style(i))
        return grid

    def _blocks(self) -> Iterator[RenderableType]:
        for i, (name, *cells) in enumerate(self.table.rows):
            yield Text(printable(name), style=f"bold {self._style(i)}".strip())
            pairs = zip(self.table.heads[1:], cells, strict=True)
            yield _Terms([(f"  {head}", cell) for head, cell in pairs if cell])

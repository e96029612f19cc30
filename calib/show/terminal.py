"""Facts as lines and grids of a terminal, which rich draws."""

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import zip_longest
from textwrap import wrap

from rich.console import JustifyMethod, RenderableType
from rich.table import Table as Grid
from rich.text import Text

from calib.base.errors import printable
from calib.show.facts import FAILED, PASSED, UNJUDGED, WARNING, Facts, Row, Table
from calib.show.numbers import unbroken

_STYLES = {FAILED: "red", WARNING: "yellow", PASSED: "green", UNJUDGED: "dim", "": ""}


@dataclass(frozen=True)
class Screen:
    """A terminal or a pipe to print on."""

    width: int  # letters in a line
    wraps: bool = True  # whether longer texts are cut into lines; a pipe does not
    quiet: bool = False  # whether the line of the verdict is enough
    details: bool = False  # whether the parts are printed

    def lines(self, text: str, width: int | None = None) -> list[str]:
        """Return a text in lines, in which a number and its unit stay together."""
        return wrap(text, width or self.width) if self.wraps else [text]


def drawn(facts: Facts, screen: Screen) -> Iterator[RenderableType]:
    """Yield lines and grids in their order in print; a plain string is a command to copy.

    The parts are details, which come before the answer. Facts without an answer show them always.
    """
    facts = _printed(facts)
    has_answer = replace(facts, parts=()).has_content
    parts = facts.parts if screen.details or not has_answer else ()
    for part in parts:
        if part.title:
            yield Text(printable(part.title), style="bold")
        yield from drawn(part, replace(screen, quiet=False))
        if has_answer or part is not parts[-1]:
            yield ""
    if text := facts.verdict_line:
        yield from _paragraph(text, screen, f"bold {_STYLES[facts.verdict]}".strip())
        if screen.quiet:
            return
    for table in facts.tables:
        if table.rows and table.caption:
            yield Text(printable(table.caption))
        if table.rows:
            yield from _table(table, screen)
    if rows := [*facts.numbers, *facts.rows]:
        yield from _terms(rows, screen)
    for note in facts.notes:
        yield from _paragraph(note, screen)
    if facts.next:
        yield f"Next: {facts.next}"


def _printed(facts: Facts) -> Facts:
    """Return the facts without pictures, warnings, and parts that have nothing else."""
    parts = [part for part in map(_printed, facts.parts) if part.has_content]
    return replace(facts, pictures=(), warnings=(), parts=parts)


def _paragraph(text: str, screen: Screen, style: str = "") -> Iterator[Text]:
    for line in screen.lines(unbroken(printable(text))):
        yield Text(line, style=style)


def _terms(rows: Sequence[Row], screen: Screen) -> Iterator[Text]:
    indent = max(len(name) for name, _ in rows) + 2
    for name, text in rows:
        width = max(screen.width - indent, 20)  # letters beside the name
        lines = screen.lines(unbroken(printable(text)), width)
        for head, line in zip_longest([printable(name)], lines or [""], fillvalue=""):
            yield Text(f"{head:<{indent}}{line}".rstrip())


def _longest_word(texts: Iterable[str]) -> int:
    """Return the length of the longest word; a no-break space does not end a word."""
    return max(len(word) for text in texts for word in text.split(" "))


def _table(table: Table, screen: Screen) -> Iterator[RenderableType]:
    """Yield a table as a grid, or as a block of lines for each row if the grid is too wide."""
    rows = [[unbroken(cell) for cell in row] for row in table.rows]
    heads, styles = list(map(unbroken, table.heads)), [_STYLES[v] for v in table.verdicts]
    styles = styles or [""] * len(rows)
    columns = list(zip(heads, table.numeric, *rows, strict=True))
    least = []  # width of each column
    for head, numeric, *cells in columns:
        cell_width = max(map(len, cells)) if numeric else _longest_word(cells)
        least.append(max(_longest_word([head]), cell_width))
    if sum(least) + 2 * (len(least) - 1) > screen.width:
        for (name, *cells), style in zip(rows, styles, strict=True):
            yield Text(printable(name), style=f"bold {style}".strip())
            pairs = zip(heads[1:], cells, strict=True)
            yield from _terms([(f"  {head}", cell) for head, cell in pairs if cell], screen)
        return
    grid = Grid(box=None, header_style="bold", pad_edge=False)
    for (head, numeric, *cells), width in zip(columns, least, strict=True):
        # rich narrows other columns first
        no_wrap = numeric or max(map(len, (head, *cells))) <= width
        justify: JustifyMethod = "right" if numeric else "left"
        title = "\n".join(wrap(head, width)) if numeric else head
        grid.add_column(title, justify=justify, no_wrap=no_wrap, min_width=width)
    for row, style in zip(rows, styles, strict=True):
        grid.add_row(*row, style=style)
    yield grid

"""Facts on a terminal, drawn by rich, which is imported with this file."""

from collections.abc import Iterator

from rich.console import JustifyMethod, RenderableType
from rich.table import Table as Grid
from rich.text import Text

from calib.base.printable import printable
from calib.show.facts import FAILED, PASSED, UNJUDGED, WARNING, Facts, Table

_STYLES = {FAILED: "red", WARNING: "yellow", PASSED: "", UNJUDGED: "dim", "": ""}


def drawn(facts: Facts) -> Iterator[RenderableType]:
    """What is printed one below the other: strings without markup, and grids. Parts come first."""
    for part in facts.parts:
        if part.filled:
            yield Text(printable(part.title), style="bold")
            yield from drawn(part)
            yield ""
    for table in facts.tables:
        if table.rows:
            yield from [table.caption] * bool(table.caption)
            yield _grid(table)
            yield from [""] * bool(table.caption)
    rows = [*facts.numbers, *facts.rows]
    width = max((len(name) for name, _ in rows), default=0)
    yield from (f"{name:<{width}}  {text}" for name, text in rows)  # whole lines, to copy from
    yield from facts.notes
    if last := ": ".join(text for text in (facts.word, facts.headline) if text):
        yield last


def _grid(table: Table) -> Grid:
    grid = Grid(box=None, header_style="bold", pad_edge=False)
    for head, numeric in zip(table.heads, table.numeric, strict=True):
        justify: JustifyMethod = "right" if numeric else "left"
        grid.add_column(head, justify=justify, overflow="fold", no_wrap=numeric)
    for i, row in enumerate(table.rows):
        grid.add_row(*row, style=_STYLES[table.verdicts[i]] if table.verdicts else "")
    return grid

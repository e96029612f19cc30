"""Grids of cells on a terminal; rich is imported only where one is drawn."""

from collections.abc import Collection
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from rich.table import Table


def grid(*heads: str, right: Collection[str] = (), fold: bool = False) -> "Table":
    """Columns by their heads, left-aligned except ``right``; ``fold`` wraps long cells."""
    from rich.table import Table

    made = Table(box=None, header_style="bold", pad_edge=False)
    for head in heads:
        made.add_column(
            head,
            justify="right" if head in right else "left",
            overflow="fold" if fold else "ellipsis",
        )
    return made


def facts_grid() -> "Table":
    """Two columns without heads: name in bold, and value."""
    from rich.table import Table

    made = Table(box=None, show_header=False, pad_edge=False)
    made.add_column(style="bold", no_wrap=True)
    made.add_column(overflow="fold")
    return made

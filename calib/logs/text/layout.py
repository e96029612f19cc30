"""Where the header and the rows of a text table stand.

"Format","MoTeC CSV File"       lines above the table: of another width, or above a blank line
"Sample Rate","100"

"Time","Brake Pressure","v"     the names
"s","bar","km/h"                their units, perhaps
"","sensor 1","gps"             what else tells them apart, perhaps

0.000,0.1,108.2                 the first of a run of rows with numbers
"""

from collections import Counter
from collections.abc import Sequence
from dataclasses import dataclass

from calib.logs.text.dialect import (
    EMPTY,
    SEPARATORS,
    Dialect,
    TextFormat,
    is_number,
    numeric_column,
    sample_of,
)
from calib.logs.text.header import is_unit_row

TOP = 200
"""Lines in which the header is looked for."""
RUN = 3
"""Rows with numbers that make a run; fewer, if the file has no more."""


@dataclass(frozen=True)
class Layout:
    """Lines of the header: ``names``, their ``units`` and ``more`` of them, empty if not there.

    ``start`` is the position of the first sample, ``above`` the number of lines above the header.
    """

    names: bytes
    start: int
    units: bytes = b""
    more: bytes = b""
    above: int = 0


def layout_of(data: bytes, begin: int, text_format: TextFormat) -> Layout:
    """The layout of a table from ``begin`` on.

    That of the separator that finds the most columns of numbers. Without a run of numbers below a
    header, the first line is the header.
    """
    lines, starts = _lines(data, begin)
    possible = [text_format.separator] if text_format.separator else list(SEPARATORS)
    sample = sample_of(data, starts[0])
    found = [_found(lines, starts, sample, s) for s in possible]
    best = max(found, key=lambda pair: pair[0])
    return best[1] or Layout(lines[0], starts[1])


def _lines(data: bytes, start: int) -> tuple[list[bytes], list[int]]:
    """The first lines from ``start``, without blank ones at the top, and where each begins."""
    lines, starts = list[bytes](), [start]
    while start < len(data) and len(lines) < TOP:
        end = data.find(b"\n", start)
        end = len(data) if end < 0 else end
        line = data[start:end].rstrip(b"\r")
        start = end + 1
        if not lines and not line.strip():
            starts[0] = start  # blank lines above everything
            continue
        lines.append(line)
        starts.append(start)
    return lines, starts


def _found(
    lines: list[bytes], starts: list[int], sample: list[str], separator: str
) -> tuple[int, Layout | None]:
    """The number of columns with numbers, and the layout; None without a header over them."""
    dialect = Dialect(separator, ".")
    width, numbers, spare = _columns(dialect.cells(sample))
    if len(numbers) < 2:
        return 0, None
    table = [dialect.cells([line.decode("latin-1")])[0] if line.strip() else [] for line in lines]
    first = _first_row(table, width, numbers)
    block = _block(table, first, (width, width - spare))
    if not block:
        return 0, None
    units = max((i for i in block[1:] if is_unit_row(table[i])), default=None)
    names = block[0] if units is None else block[block.index(units) - 1]
    more = [i for i in block if i > (names if units is None else units)]

    def line(index: int) -> bytes:
        return lines[index] + separator.encode() * (width - len(table[index]))

    return len(numbers), Layout(
        line(names),
        starts[first],
        b"" if units is None else line(units),
        line(more[0]) if more else b"",
        sum(bool(row) for row in table[:names]),
    )


def _columns(rows: Sequence[Sequence[str]]) -> tuple[int, list[int], bool]:
    """The width of most rows, their columns of numbers, and whether the last cell is always empty.

    A separator at the end of each row makes such a cell, over which a header may have none.
    """
    ((width, _),) = Counter(len(row) for row in rows if row).most_common(1) or [(0, 0)]
    columns = list(zip(*(row for row in rows if len(row) == width), strict=True))
    numbers = [i for i, column in enumerate(columns) if numeric_column(column)]
    return width, numbers, sum(map(bool, columns[-1])) <= 1 if columns else False


def _first_row(table: Sequence[Sequence[str]], width: int, numbers: Sequence[int]) -> int:
    """The first of a run of rows with numbers; the number of lines without such a run."""

    def is_row(row: Sequence[str]) -> bool:
        cells = [row[i] for i in numbers if row[i] not in EMPTY] if len(row) == width else []
        return any(is_number(c, ".") or is_number(c, ",") for c in cells) and not is_unit_row(row)

    filled = [i for i, row in enumerate(table) if row]
    for place, index in enumerate(filled):
        if all(is_row(table[i]) for i in filled[place : place + RUN]):
            return index
    return len(table)


def _block(table: Sequence[Sequence[str]], first: int, widths: tuple[int, int]) -> list[int]:
    """The lines of the header above the ``first`` row: names, or names over a blank and units."""
    block: list[int] = []
    for index in range(min(first, len(table)) - 1, -1, -1):
        row = table[index]
        if not row and (not block or is_unit_row(table[block[0]])):
            continue
        if len(row) not in widths:
            break
        block.insert(0, index)
    return block

"""Format of a text table: where its header and rows stand, separator and decimal mark.

"Format","MoTeC CSV File"       lines above the table: of another width, or above a blank line
"Sample Rate","100"

"Time","Brake Pressure","v"     the names
"s","bar","km/h"                their units, perhaps
"","sensor 1","gps"             what else tells them apart, perhaps

0.000,0.1,108.2                 the first of a run of rows with numbers

The header and rows from the beginning, the middle and the end are tried with each separator. If
exactly one fits, it is used. If several or none fit, the error lists them and shows the entry of a
channel map that decides: ``separator`` and ``decimal`` of [text].
"""

import csv
import re
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from calib.base.errors import LogError
from calib.logs.text.cells import is_unit_row

SEPARATORS = {",": "comma", ";": "semicolon", "\t": "tab", "|": "vertical bar"}
EMPTY = ("", "nan", "NaN", "NAN", "NA", "N/A", "null")
"""Cells without a value."""

csv.field_size_limit(sys.maxsize)  # of cells in memory; what is no number is refused as that

_POINT, _COMMA = (
    re.compile(rf"[-+]?(\d++({mark}\d*+)?|{mark}\d++)(e[-+]?\d++)?|[-+]?inf(inity)?", re.IGNORECASE)
    for mark in (r"\.", ",")
)
"""Possessive: a cell of many digits that is no number costs no more than its length."""
_NUMBER = {".": _POINT, ",": _COMMA}
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}([.,]\d{3})+")
"""Numbers such as ``1,234``: the comma is a decimal mark or separates thousands."""


@dataclass(frozen=True)
class TextFormat:
    """Text format from a channel map; None is detected from the file."""

    separator: str | None = None
    decimal: str | None = None
    encoding: str | None = None

    @property
    def separators(self) -> list[str]:
        """The separators that are possible."""
        return [self.separator] if self.separator else list(SEPARATORS)


LOOKED = TextFormat()
"""Everything is detected from the file."""


@dataclass(frozen=True)
class Dialect:
    """Separator between cells, and the decimal mark in numbers."""

    separator: str
    decimal: str

    def cells(self, lines: list[str]) -> list[list[str]]:
        """The cells of some lines, each by itself, without blanks around them."""
        rows = (next(csv.reader([line], delimiter=self.separator), []) for line in lines)
        return [[cell.strip() for cell in row] for row in rows]


def _is_number(cell: str, decimal: str = ".") -> bool:
    """Whether a cell holds a number with this decimal mark."""
    return _NUMBER[decimal].fullmatch(cell) is not None


def sample_of(data: bytes, start: int, count: int = 8, width: int = 16384) -> list[str]:
    """Complete lines from ``start``, the middle and the end of a file, some twice if short."""

    def complete(begin: int) -> list[bytes]:
        end = begin + width
        end = len(data) if end >= len(data) else data.rfind(b"\n", begin, end) + 1
        return data[begin:end].splitlines()

    head = complete(start)[:count]
    middle = complete((start + len(data)) // 2)[1 : count + 1]
    tail = data[max(start, len(data) - width) :].rstrip(b"\r\n").splitlines()[-count:]
    return [line.decode(errors="replace") for line in (*head, *middle, *tail) if line.strip()]


def dialect_of(
    layouts: "Sequence[_Layout]", data: bytes, text_format: TextFormat, where: str
) -> Dialect:
    """The dialect of a table. Raises LogError, with the candidates, for none or several of them."""
    separators = [one.separator for one in layouts if one.separator]
    if len(layouts) != 1 and separators:
        names = " or ".join(f"{SEPARATORS[s]} ({s!r})" for s in separators)
        raise LogError(
            f"the columns may be separated by {names}",
            where=where,
            expected="one separator that fits",
            do='give it in a channel map (--map): [text] with separator = "' + separators[0] + '"',
        )
    if not separators:
        expected = "rows of as many numbers, separated by comma, semicolon, tab or bar"
        raise LogError(
            "no separator fits this table",
            where=where,
            expected=f"a header, and {expected}",
            do="decimal commas need another separator than the comma; see the first lines of the "
            "file",
        )
    (layout,) = layouts
    decimal = text_format.decimal or _decimal(layout.separator, data, layout.start, where)
    return Dialect(layout.separator, decimal)


def mostly(kind: Callable[[str], bool], column: Sequence[str]) -> bool:
    """Whether more than half of the cells with a value are of a kind."""
    filled = [cell for cell in column if cell not in EMPTY]
    return 2 * sum(map(kind, filled)) > len(filled)


def _any_number(cell: str) -> bool:
    return _is_number(cell, ".") or _is_number(cell, ",")


def _decimal(separator: str, data: bytes, start: int, where: str) -> str:
    rows = Dialect(separator, ".").cells(sample_of(data, start))
    cells = [cell for row in rows for cell in row]
    numbers = {mark: [c for c in cells if mark in c and _is_number(c, mark)] for mark in ".,"}
    marks = [mark for mark in numbers if numbers[mark]]
    if not marks:
        # Only whole numbers in the sample. Another mark later in the file is an error when read.
        comma = data.find(b",", start) >= 0 and data.find(b".", start) < 0
        return "," if separator != "," and comma else "."
    clear = [m for m in marks if not all(_THOUSANDS.fullmatch(c) for c in numbers[m])]
    if len(marks) == 1 and (clear or separator == ","):
        return marks[0]
    examples = ", ".join(repr(Counter(numbers[m]).most_common(1)[0][0]) for m in marks)
    raise LogError(
        f"the decimal mark is ambiguous: {examples}",
        where=where,
        expected="one mark, and no separator of thousands",
        do='give it in a channel map (--map): [text] with decimal = "," or decimal = "."',
    )


_TOP = 200
"""Lines in which the header is looked for."""
_RUN = 3
"""Rows with numbers that make a run; fewer, if the file has no more."""


@dataclass(frozen=True)
class _Layout:
    """Lines of the header: ``names``, ``units`` and ``more``, and where the first sample begins."""

    names: bytes
    start: int
    units: bytes = b""
    more: bytes = b""
    above: int = 0
    separator: str = ""
    numbers: int = 0


def layouts_of(data: bytes, begin: int, text_format: TextFormat) -> list[_Layout]:
    """The layouts of a table from ``begin`` on: one, if its separator is clear.

    The first has the most columns of numbers, the others are as good. It has no separator if no
    header stands over numbers.
    """
    lines, starts = _lines(data, begin)
    sample = sample_of(data, starts[0])
    layouts = [x for s in text_format.separators if (x := _layout(lines, starts, sample, s))]
    best = max(layouts, key=lambda x: x.numbers, default=_Layout(lines[0], starts[1]))
    return [best, *(x for x in layouts if x is not best and x.start == best.start)]


def _lines(data: bytes, start: int) -> tuple[list[bytes], list[int]]:
    """The first lines from ``start``, without blank ones at the top, and where each begins."""
    lines, starts = list[bytes](), [start]
    while start < len(data) and len(lines) < _TOP:
        end = data.find(b"\n", start)
        end = len(data) if end < 0 else end
        line = data[start:end].rstrip(b"\r")
        start = end + 1
        if lines and lines[-1].count(b'"') % 2 == 1:  # a cell with a line break
            lines[-1] += b" " + line
            starts[-1] = start
            continue
        if not lines and not line.strip():
            starts[0] = start  # blank lines above everything
            continue
        lines.append(line)
        starts.append(start)
    return lines, starts


def _layout(
    lines: list[bytes], starts: list[int], sample: list[str], separator: str
) -> _Layout | None:
    """The layout by a separator; None without a header over two columns of numbers."""
    dialect = Dialect(separator, ".")
    rows = dialect.cells(sample)
    ((width, _),) = Counter(len(row) for row in rows if row).most_common(1) or [(0, 0)]
    columns = list(zip(*(row for row in rows if len(row) == width), strict=True))
    numbers = [i for i, column in enumerate(columns) if mostly(_any_number, column)]
    spare = bool(columns) and sum(map(bool, columns[-1])) <= 1  # each row ends with a separator
    if len(numbers) < 2:
        return None
    table = [dialect.cells([line.decode("latin-1")])[0] if line.strip() else [] for line in lines]
    first = _first_row(table, width, numbers)
    block = _block(table, first, (width, width - spare))
    if not block:
        return None
    units = max((i for i in block[1:] if is_unit_row(table[i])), default=None)
    names = block[0] if units is None else block[block.index(units) - 1]
    more = [i for i in block if i > (names if units is None else units)]

    def line(index: int) -> bytes:
        return lines[index] + separator.encode() * (width - len(table[index]))

    return _Layout(
        line(names),
        starts[first],
        b"" if units is None else line(units),
        line(more[0]) if more else b"",
        sum(bool(row) for row in table[:names]),
        separator,
        len(numbers),
    )


def _first_row(table: Sequence[Sequence[str]], width: int, numbers: Sequence[int]) -> int:
    """The first of a run of rows with numbers; the number of lines without such a run."""

    def is_row(row: Sequence[str]) -> bool:
        cells = [row[i] for i in numbers if row[i] not in EMPTY] if len(row) == width else []
        return any(map(_any_number, cells)) and not is_unit_row(row)

    filled = [i for i, row in enumerate(table) if row]
    for place, index in enumerate(filled):
        if all(is_row(table[i]) for i in filled[place : place + _RUN]):
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

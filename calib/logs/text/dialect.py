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
import io
import re
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from dataclasses import dataclass

from calib.base.errors import LogError
from calib.logs.text.cells import is_unit_row

SEPARATORS = {",": "comma", ";": "semicolon", "\t": "tab", "|": "vertical bar"}
EMPTY = ("", "nan", "NaN", "NAN", "NA", "N/A", "null")  # cells without a value

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


LOOKED = TextFormat()  # everything is detected from the file


def cells_of(line: str, separator: str) -> list[str]:
    """The cells of a line, without blanks around them; none of an empty line."""
    if '"' in line:
        cells = next(csv.reader([line.replace("\r", " ")], delimiter=separator), [])
    else:
        cells = line.split(separator) if line else []
    return [cell.strip() for cell in cells]


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


def mostly(kind: Callable[[str], bool], column: Sequence[str]) -> bool:
    """Whether more than half of the cells with a value are of this ``kind``."""
    filled = [cell for cell in column if cell not in EMPTY]
    return 2 * sum(map(kind, filled)) > len(filled)


def _any_number(cell: str) -> bool:
    return bool(_POINT.fullmatch(cell) or _COMMA.fullmatch(cell))


def decimal_of(rows: Sequence[Sequence[str]], separator: str, where: str) -> str:
    """The decimal mark of sampled rows of cells. Raises LogError if it is ambiguous."""
    cells = [cell for row in rows for cell in row]
    numbers = {m: [c for c in cells if m in c and _NUMBER[m].fullmatch(c)] for m in ".,"}
    marks = [mark for mark in numbers if numbers[mark]]
    if not marks:  # whole numbers: a mark elsewhere in the file is an error when it is read
        return "."
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


_TOP = 200  # lines in which the header is looked for
_RUN = 3  # rows with numbers that make a run; fewer, if the file has no more


@dataclass(frozen=True)
class Layout:
    """Lines of the header, the byte ``start`` of the first sample, and columns of ``numbers``."""

    separator: str
    names: bytes
    units: bytes
    more: bytes
    start: int
    numbers: list[int]


def layout_of(data: bytes, begin: int, text_format: TextFormat, where: str) -> Layout:
    """The layout of a table from ``begin`` on, with the most columns of numbers.

    Raises LogError if no separator gives one, or if two give one that begins in the same row.
    """
    lines, starts = _lines(data, begin)
    sample = sample_of(data, starts[0])
    separators = [s for s in text_format.separators if any(s in line for line in sample)]
    layouts = [x for s in separators if (x := _layout(lines, starts, sample, s))]
    layouts.sort(key=lambda x: -len(x.numbers))
    others = [x.separator for x in layouts if x.start == layouts[0].start]
    if len(others) == 1:
        return layouts[0]
    if others:
        names = " or ".join(f"{SEPARATORS[s]} ({s!r})" for s in others)
        raise LogError(
            f"the columns may be separated by {names}",
            where=where,
            expected="one separator that fits",
            do=f'give it in a channel map (--map): [text] with separator = "{others[0]}"',
        )
    below = [line.decode("latin-1") for line in lines if line.strip()][1:]
    units = (is_unit_row(cells_of(below[0], s)) for s in text_format.separators)
    if not below or (len(below) == 1 and any(units)):
        raise LogError("a header and no samples", where=where, expected="at least 50 rows")
    expected = "rows of as many numbers, separated by comma, semicolon, tab or bar"
    raise LogError(
        "no separator fits this table",
        where=where,
        expected=f"a header, and {expected}",
        do="decimal commas need another separator than the comma; see the first lines of the file",
    )


def _lines(data: bytes, start: int) -> tuple[list[bytes], list[int]]:
    """The first lines from ``start``, without blank ones at the top, and where each begins."""
    lines, starts = list[bytes](), [start]
    stream = io.BytesIO(data)
    stream.seek(start)
    for whole in stream:
        start += len(whole)
        line = whole.rstrip(b"\r\n")
        if lines and lines[-1].count(b'"') % 2 == 1:  # a cell with a line break
            lines[-1] += b" " + line
            starts[-1] = start
        elif lines or line.strip():
            lines.append(line)
            starts.append(start)
        else:  # blank lines above everything
            starts[0] = start
        if len(lines) == _TOP:
            break
    return lines, starts


def _layout(
    lines: list[bytes], starts: list[int], sample: list[str], separator: str
) -> Layout | None:
    """The layout by a separator; None without two columns of numbers and a header over them."""
    rows = [row for line in sample if (row := cells_of(line, separator))]
    ((width, _),) = Counter(map(len, rows)).most_common(1) or [(0, 0)]
    columns = list(zip(*(row for row in rows if len(row) == width), strict=True))
    numbers = [i for i, column in enumerate(columns) if mostly(_any_number, column)]
    if len(numbers) < 2:
        return None
    table, run = list[list[str]](), list[int]()
    for index, line in enumerate(lines):
        row = cells_of(line.decode("latin-1"), separator) if line.strip() else []
        table.append(row)
        if row:
            run = [*run, index] if _is_sample(row, width, numbers) else []
        if len(run) == _RUN:
            break
    first = run[0] if run else len(table)
    spare = sum(map(bool, columns[-1])) <= 1  # each row ends with a separator
    block = _block(table, first, (width, width - spare))
    if not block:
        return None
    units = max((i for i in block[1:] if is_unit_row(table[i])), default=None)
    names = block[0] if units is None else block[block.index(units) - 1]
    more = next((i for i in block if i > (names if units is None else units)), None)
    names_line, units_line, more_line = (
        b"" if i is None else lines[i] + separator.encode() * (width - len(table[i]))
        for i in (names, units, more)
    )
    return Layout(separator, names_line, units_line, more_line, starts[first], numbers)


def _is_sample(row: Sequence[str], width: int, numbers: Sequence[int]) -> bool:
    """Whether a row has a number in one of the columns of ``numbers``, and no units."""
    cells = [row[i] for i in numbers if row[i] not in EMPTY] if len(row) == width else []
    return any(map(_any_number, cells)) and not is_unit_row(row)


def _block(table: Sequence[Sequence[str]], first: int, widths: tuple[int, int]) -> list[int]:
    """Indices of the lines of the header above the ``first`` row of samples.

    Blank lines below it, and above its row of units, are passed over.
    """
    block: list[int] = []
    for index in range(first - 1, -1, -1):
        row = table[index]
        if not row and (not block or is_unit_row(table[block[0]])):
            continue
        if len(row) not in widths:
            break
        block.insert(0, index)
    return block

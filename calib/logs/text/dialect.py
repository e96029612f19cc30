"""Find the format of a text table: the place of its header and rows, separator and decimal mark.

"Format","MoTeC CSV File"       lines above the table: of another width, or above a blank line
"Sample Rate","100"

"Time","Brake Pressure","v"     the names
"s","bar","km/h"                perhaps a row of units
"","sensor 1","gps"             perhaps a row of remarks

0.000,0.1,108.2                 the first of several rows with numbers

Each separator is tried on the header and on rows from the beginning, the middle and the end. Of the
separators that fit, the one with the most columns of numbers is taken. If two give tables that
begin in the same row, the error asks for ``separator`` in [text] of a channel map; if the decimal
mark is ambiguous, for ``decimal``.
"""

import csv
import io
import re
import sys
from collections import Counter
from collections.abc import Callable, Collection, Sequence
from dataclasses import dataclass

from calib.base.errors import LogError
from calib.logs.text.cells import EMPTY, is_unit_row

SEPARATORS = {",": "comma", ";": "semicolon", "\t": "tab", "|": "vertical bar"}

csv.field_size_limit(sys.maxsize)  # a cell that is too long is refused later, as it is no number

_NUMBER = {
    mark: re.compile(
        rf"[-+]?(\d++([{mark}]\d*+)?|[{mark}]\d++)(e[-+]?\d++)?|[-+]?inf(inity)?", re.IGNORECASE
    )
    for mark in ".,"
}
"""Numbers by decimal mark. With the possessive quantifiers (``++``), the time for a cell of many
digits that is no number grows only with its length."""
_THOUSANDS = re.compile(r"[-+]?[1-9]\d{0,2}([.,]\d{3})+")  # 1,234 may be a number of thousands


@dataclass(frozen=True)
class TextFormat:
    """Format of text that a channel map gives; None is detected from the file."""

    separator: str | None = None
    decimal: str | None = None
    encoding: str | None = None


DETECTED = TextFormat()


def cells_of(line: str, separator: str) -> list[str]:
    """Split a line into cells without blanks around them; an empty line has none."""
    if '"' in line:
        cells = next(csv.reader([line.replace("\r", " ")], delimiter=separator), [])
    else:
        cells = line.split(separator) if line else []
    return [cell.strip() for cell in cells]


_LINES, _BYTES = 8, 16384  # most lines and bytes that are read at each place of a sample


def sample_of(data: bytes, start: int) -> list[str]:
    """Return lines from ``start``, the middle and the end; some twice if the file is short."""
    head = _lines_from(data, start)[:_LINES]
    # the first line from the middle may lack its beginning
    middle = _lines_from(data, (start + len(data)) // 2)[1 : _LINES + 1]
    tail = data[max(start, len(data) - _BYTES) :].rstrip(b"\r\n").splitlines()[-_LINES:]
    return [line.decode(errors="replace") for line in (*head, *middle, *tail) if line.strip()]


def _lines_from(data: bytes, begin: int) -> list[bytes]:
    end = begin + _BYTES
    end = len(data) if end >= len(data) else data.rfind(b"\n", begin, end) + 1
    return data[begin:end].splitlines()


def mostly(is_kind: Callable[[str], bool], column: Sequence[str]) -> bool:
    """Whether ``is_kind`` is true of more than half of the cells that are not empty."""
    filled = [cell for cell in column if cell not in EMPTY]
    return 2 * sum(map(is_kind, filled)) > len(filled)


def _is_number(cell: str) -> bool:
    return any(number.fullmatch(cell) for number in _NUMBER.values())


def decimal_of(rows: Sequence[Sequence[str]], separator: str, where: str) -> str:
    """Find the decimal mark in some rows of cells. Raises LogError if it is ambiguous."""
    cells = [cell for row in rows for cell in row]
    numbers = {
        mark: [cell for cell in cells if mark in cell and number.fullmatch(cell)]
        for mark, number in _NUMBER.items()
    }
    marks = [mark for mark in numbers if numbers[mark]]
    if not marks:  # whole numbers; another mark later in the file is an error when it is read
        return "."
    if len(marks) == 1:
        may_be_thousands = all(map(_THOUSANDS.fullmatch, numbers[marks[0]]))
        # programs that separate cells by commas do not write "1.234" for a thousand
        if separator == "," or not may_be_thousands:
            return marks[0]
    examples = ", ".join(repr(Counter(numbers[mark]).most_common(1)[0][0]) for mark in marks)
    flaw = f"the decimal mark is ambiguous: {examples}"
    expected = "one mark, and no separator of thousands"
    do = 'give it in a channel map (--map): [text] with decimal = "," or decimal = "."'
    raise LogError(flaw, where=where, expected=expected, do=do)


_TOP = 200  # lines in which the header is looked for
_FIRST_ROWS = 3  # number of rows with numbers, one below the other, that begin the samples


@dataclass(frozen=True)
class Layout:
    """Format of a table, its header, and the place of its samples."""

    separator: str
    header: bytes  # three lines with names, units and remarks; the last two may be empty
    start: int  # first byte of the first sample
    numbers: list[int]  # indices of the columns of numbers


def layout_of(data: bytes, begin: int, text_format: TextFormat, where: str) -> Layout:
    """Find the layout of the table from byte ``begin`` on. Raises LogError unless one fits."""
    lines, starts = _lines(data, begin)
    sample = sample_of(data, starts[0])
    separators = [text_format.separator] if text_format.separator else list(SEPARATORS)
    used = [s for s in separators if any(s in line for line in sample)]
    fitting = [layout for s in used if (layout := _layout(lines, starts, sample, s))]
    if fitting:
        best = max(fitting, key=lambda layout: len(layout.numbers))
        rivals = [best, *(x for x in fitting if x is not best and x.start == best.start)]
        if len(rivals) == 1:
            return best
        names = [f"{SEPARATORS[x.separator]} ({x.separator!r})" for x in rivals]
        flaw = f"the columns may be separated by {' or '.join(names)}"
        do = f'give it in a channel map (--map): [text] with separator = "{best.separator}"'
        raise LogError(flaw, where=where, expected="one separator that fits", do=do)
    below_names = [line.decode("latin-1") for line in lines if line.strip()][1:]
    if len(below_names) == 1 and any(is_unit_row(cells_of(below_names[0], s)) for s in separators):
        below_names = []  # a row of units is no sample
    if not below_names:
        raise LogError("a header and no samples", where=where, expected="at least 50 rows")
    flaw = "no header with rows of numbers below it"
    expected = "a header, and rows of as many numbers, separated by comma, semicolon, tab or bar"
    do = "look at the first lines; decimal commas need another separator than the comma"
    raise LogError(flaw, where=where, expected=expected, do=do)


def _lines(data: bytes, start: int) -> tuple[list[bytes], list[int]]:
    """Return k lines from byte ``start``, without blank lines at the top, and k + 1 places.

    The places are the first byte of each line, and the byte after the last line.
    """
    lines, starts = list[bytes](), [start]
    stream = io.BytesIO(data)
    stream.seek(start)
    for line_with_end in stream:
        start += len(line_with_end)
        line = line_with_end.rstrip(b"\r\n")
        if lines and lines[-1].count(b'"') % 2 == 1:  # a line break within a cell in quotes
            lines[-1] += b" " + line
            starts[-1] = start
        elif lines or line.strip():
            lines.append(line)
            starts.append(start)
        else:  # leave out a blank line at the top
            starts[0] = start
        if len(lines) == _TOP:
            break
    return lines, starts


def _layout(
    lines: list[bytes], starts: list[int], sample: list[str], separator: str
) -> Layout | None:
    """Return the layout with this separator, or None without a header or two columns of numbers."""
    rows = [row for line in sample if (row := cells_of(line, separator))]
    count = Counter(map(len, rows))  # number of rows by their number of cells
    width = max(count, key=lambda cells: count[cells], default=0)
    columns = list(zip(*(row for row in rows if len(row) == width), strict=True))
    numbers = [i for i, column in enumerate(columns) if mostly(_is_number, column)]
    if len(numbers) < 2:
        return None
    table = list[list[str]]()
    samples = list[int]()  # indices of the samples read so far that no other row follows
    for index, line in enumerate(lines):
        row = cells_of(line.decode("latin-1"), separator) if line.strip() else []
        table.append(row)
        if row:
            samples = [*samples, index] if _is_sample(row, width, numbers) else []
        if len(samples) == _FIRST_ROWS:
            break
    first = samples[0] if samples else len(table)
    # if each row ends with a separator, the last column has no cell but perhaps that of the header
    ends_with_separator = sum(map(bool, columns[-1])) <= 1
    header = _header(table, first, (width, width - 1) if ends_with_separator else (width,))
    if not header:
        return None
    # the row above the last row of units has the names, the row below it the remarks
    unit_rows = [i for i in header[1:] if is_unit_row(table[i])]
    top = header.index(unit_rows[-1]) - 1 if unit_rows else 0
    padded = [lines[i] + separator.encode() * (width - len(table[i])) for i in header[top:]]
    if not unit_rows:
        padded.insert(1, b"")
    three_lines = [*padded, b"", b""][:3]
    return Layout(separator, b"\n".join(three_lines), starts[first], numbers)


def _is_sample(row: Sequence[str], width: int, numbers: Sequence[int]) -> bool:
    """Whether a row has a number in one of the columns ``numbers``, and is no row of units."""
    if len(row) != width or is_unit_row(row):
        return False
    return any(_is_number(row[i]) for i in numbers if row[i] not in EMPTY)


def _header(table: Sequence[Sequence[str]], first: int, widths: Collection[int]) -> list[int]:
    """Indices of the lines of the header above the ``first`` row of samples.

    Going up, the header begins below the first line of another width. Blank lines may stand below
    the header and above its row of units.
    """
    header: list[int] = []
    for index in range(first - 1, -1, -1):
        row = table[index]
        may_be_blank = not header or is_unit_row(table[header[0]])
        if row or not may_be_blank:
            if len(row) not in widths:
                break
            header.insert(0, index)
    return header

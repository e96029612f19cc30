"""Read separated text: CSV in the format of the project, and tables of many other programs.

bytes --to_utf8--> text --layout_of--> header --_columns--> columns
                                       rows --decimal_of, TextRows--> numbers
"""

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.logs.parquet import numbers
from calib.logs.source import Column, ColumnSource, damaged
from calib.logs.text.cells import EMPTY, clock_seconds, column_from_cell, is_clock, with_unit_row
from calib.logs.text.dialect import (
    DETECTED,
    TextFormat,
    cells_of,
    decimal_of,
    layout_of,
    mostly,
    sample_of,
)
from calib.logs.text.encoding import GZIP, gunzip, text_of, to_utf8


def open_csv(data: bytes, where: str, text_format: TextFormat = DETECTED) -> ColumnSource:
    """Open separated text, gzip or not. Raises LogError if it is no table, ambiguous or cut off."""
    if data.startswith(GZIP):
        data = gunzip(data, where)
    text = to_utf8(data, where, text_format.encoding)
    data = text.rstrip(b"\0")  # a logger that lost its power leaves zeros
    zeros = len(text) - len(data)
    if b"\n" not in data:
        data = data.replace(b"\r", b"\n")
    if not data or data.isspace():
        raise LogError("the file is empty", where=where, expected="a header and samples")
    begin = 0
    # a spreadsheet may declare the separator in the first line
    declared = re.match(rb"\s*sep=([,;\t|])[^\S\r\n]*\r?\n", data, re.IGNORECASE)
    if declared:
        begin = declared.end()
        text_format = replace(text_format, separator=text_format.separator or declared[1].decode())
    layout = layout_of(data, begin, text_format, where)
    header, encoding_note = text_of(layout.header)
    separator = layout.separator
    names, units, remarks = (cells_of(line, separator) for line in header.split("\n"))
    columns = _columns(names, units, remarks, where)
    rows = [cells_of(line, separator) for line in sample_of(data, layout.start)]
    decimal = text_format.decimal or decimal_of(rows, separator, where)
    notes = [f"{zeros} zero bytes at the end were not read" if zeros else None, encoding_note]
    clocks = set[int]()
    for i, column in enumerate(columns):
        cells = [row[i] for row in rows if len(row) > i]
        if i not in layout.numbers and mostly(is_clock, cells):
            clocks.add(i)
            columns[i] = Column(column.name, "s", column.full or names[i])
            notes.append(f"{column.name}: a clock, counted from its first row")
    table = TextRows(data, layout.start, tuple(columns), where, separator, decimal, clocks)
    notes.append(table.check_end())
    return ColumnSource(table.columns, table.read, tuple(filter(None, notes)))


def _columns(names: list[str], units: list[str], remarks: list[str], where: str) -> list[Column]:
    columns = [column_from_cell(cell) for cell in names]
    if units:
        columns = with_unit_row(columns, units, where)
    if remarks:
        columns = [
            replace(column, full=f"{column.full_name} {remark}") if remark else column
            for column, remark in zip(columns, remarks, strict=True)
        ]
    return columns


@dataclass(frozen=True)
class TextRows:
    """The rows of a table, which begin at byte ``start`` of ``data``."""

    data: bytes
    start: int
    columns: tuple[Column, ...]
    where: str
    separator: str
    decimal: str = "."
    clocks: Collection[int] = ()  # indices of the columns that hold times instead of numbers

    def check_end(self) -> str | None:
        r"""Check the last row. Return a note if it has no end of line.

        Raises LogError if the last row is cut off:
        0.005,0.10,74.4800\n
        0.010,0.20,74.4           a shorter number and no end of line
        """
        data, start, width = self.data, self.start, len(self.columns)
        tail_size = 20 * 64 * width  # bytes of the last 20 rows, with 64 for each cell
        tail = data[max(start, len(data) - tail_size) :].rstrip(b"\r\n")
        if not tail:  # only blank lines: look before them
            tail = data[start:].rstrip(b"\r\n")[-tail_size:]
        lines = [line.decode(errors="replace") for line in tail.splitlines()[-20:]]
        *before_last, last = (cells_of(line, self.separator) for line in lines)
        earlier = [row for row in before_last if row]
        other_widths = [len(row) for row in earlier if len(row) != width]
        if 2 * len(other_widths) > len(earlier):
            rows = f"{len(other_widths)} of the {len(earlier)} rows before the last one"
            flaw = f"{rows} have {min(other_widths)} to {max(other_widths)} cells"
            expected = f"a table: {width} cells in each row, as the header has"
            raise LogError(flaw, where=self.where, expected=expected)
        has_line_end = data.endswith((b"\n", b"\r"))
        is_cut = len(last) < width or lines[-1].count('"') % 2 == 1
        if not is_cut and not has_line_end:
            is_cut = self._is_shorter(last[-1], [row[-1] for row in earlier])
        if is_cut:
            flaw = f"the last line is cut off: {lines[-1][:60]!r}"
            raise damaged(self.where, flaw, f"{width} whole cells")
        return None if has_line_end else "no end of line after the last row, which looks complete"

    def _is_shorter(self, cell: str, earlier: list[str]) -> bool:
        """Whether the last cell of a file is shorter than all ``earlier`` cells of its column."""
        if not earlier:
            return False
        decimals = [len(text.partition(self.decimal)[2]) for text in earlier]
        if len(set(decimals)) == 1:  # all have equally many, so that decimals are compared
            return len(cell.partition(self.decimal)[2]) < decimals[0]
        return len(cell) < min(map(len, earlier))

    def read(self, indices: Sequence[int]) -> list[Array]:
        """Read columns as numbers (n,), clocks as seconds. Raises LogError that names a bad row."""
        import pyarrow as pa
        import pyarrow.csv as arrow_csv

        names = [str(i) for i in range(len(self.columns))]
        types = {str(i): pa.string() if i in self.clocks else pa.float64() for i in indices}
        try:
            table = arrow_csv.read_csv(
                pa.BufferReader(pa.py_buffer(self.data).slice(self.start)),
                read_options=arrow_csv.ReadOptions(column_names=names, use_threads=False),
                parse_options=arrow_csv.ParseOptions(delimiter=self.separator),
                convert_options=arrow_csv.ConvertOptions(
                    include_columns=[str(i) for i in indices],
                    column_types=types,
                    null_values=list(EMPTY),
                    decimal_point=self.decimal,
                ),
            )
        except pa.ArrowInvalid as cause:
            raise self._bad_row(str(cause)) from cause
        return [
            clock_seconds(column.to_pylist(), f"{self.where}: {self.columns[i].name}")
            if i in self.clocks
            else numbers(column)
            for i, column in zip(indices, table.columns, strict=True)
        ]

    def _bad_row(self, cause: str) -> LogError:
        """Return the error for a row that pyarrow cannot read, from the text of pyarrow's error."""
        if cell := re.search(
            r"column #(\d+): Row #(\d+): .*?invalid value '(.*)'", cause, re.DOTALL
        ):
            mark = {".": "point", ",": "comma"}[self.decimal]
            flaw = f"row {cell[2]}: {cell[3].strip()[:60]!r} is not a number"
            place = f"{self.where}: {self.columns[int(cell[1])].name}"
            expected = f"a number with a decimal {mark}, or an empty cell"
            return LogError(flaw, where=place, expected=expected)
        if row := re.search(r"Row #(\d+): Expected (\d+) columns, got (\d+)", cause):
            flaw, expected = f"row {row[1]} has {row[3]} cells", f"{row[2]}, as the header has"
            do = "look at the row; was the log written by two programs at once?"
            return LogError(flaw, where=self.where, expected=expected, do=do)
        flaw = f"not readable as CSV: {cause[:200]}"
        return LogError(flaw, where=self.where, expected="separated text")

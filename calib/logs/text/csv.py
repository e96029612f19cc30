"""Separated text: the canonical ``name [unit]`` with commas, and the styles of other programs."""

import re
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace

from calib.base.arrays import Array
from calib.base.errors import LogError
from calib.logs.parquet import numbers
from calib.logs.source import Column, ColumnSource, damaged
from calib.logs.text.cells import clock_seconds, column_from_cell, is_clock, with_unit_row
from calib.logs.text.dialect import (
    EMPTY,
    LOOKED,
    TextFormat,
    cells_of,
    decimal_of,
    layout_of,
    mostly,
    sample_of,
)
from calib.logs.text.encoding import GZIP, gunzip, text_of, to_utf8


def open_csv(data: bytes, where: str, text_format: TextFormat = LOOKED) -> ColumnSource:
    """Open separated text, compressed by gzip or not; ``where`` is its path.

    Raises LogError for a file without header or rows, an ambiguous dialect, or one that is cut off.
    """
    if data.startswith(GZIP):
        data = gunzip(data, where)
    whole = to_utf8(data, where, text_format.encoding)
    data = whole.rstrip(b"\0")  # a logger that lost its power leaves them
    zeros = len(whole) - len(data)
    if b"\n" not in data:
        data = data.replace(b"\r", b"\n")
    if not data or data.isspace():
        raise LogError("the file is empty", where=where, expected="a header and samples")
    begin = 0
    declared = re.match(rb"\s*sep=([,;\t|])[^\S\r\n]*\r?\n", data, re.IGNORECASE)  # of spreadsheets
    if declared:
        begin = declared.end()
        text_format = replace(text_format, separator=text_format.separator or declared[1].decode())
    layout = layout_of(data, begin, text_format, where)
    header, note = text_of(b"\n".join((layout.names, layout.units, layout.more)))
    separator = layout.separator
    cells, units, more = (cells_of(line, separator) for line in header.split("\n"))
    columns = _header(cells, units, more, where)
    rows = [row for line in sample_of(data, layout.start) if (row := cells_of(line, separator))]
    decimal = text_format.decimal or decimal_of(rows, separator, where)
    texts = set(range(len(columns))) - set(layout.numbers)
    clocks = [i for i in sorted(texts) if mostly(is_clock, [r[i] for r in rows if len(r) > i])]
    for i in clocks:
        columns[i] = Column(columns[i].name, "s", columns[i].full or cells[i])
    lost = f"{zeros} zero bytes at the end were not read" if zeros else ""
    counted = [f"{columns[i].name}: a clock, counted from its first row" for i in clocks]
    table = TextRows(data, layout.start, tuple(columns), where, separator, decimal, {*clocks})
    notes = tuple(n for n in (lost, note, *counted, table.end()) if n)
    return ColumnSource(table.columns, table.read, notes)


def _header(names: list[str], units: list[str], more: list[str], where: str) -> list[Column]:
    """The columns of a header of up to three rows."""
    columns = [column_from_cell(cell) for cell in names]
    if units:
        columns = with_unit_row(columns, units, where)
    return [
        replace(column, full=f"{column.full_name} {text}") if text else column
        for column, text in zip(columns, more or [""] * len(columns), strict=True)
    ]


@dataclass(frozen=True)
class TextRows:
    """The rows of a table: ``data`` from byte ``start`` on."""

    data: bytes
    start: int
    columns: tuple[Column, ...]
    where: str
    separator: str
    decimal: str = "."
    clocks: Collection[int] = ()

    def end(self) -> str | None:
        r"""Check the last row: LogError if it is cut off, a note if it has no end of line.

        0.005,0.10,74.4800\n
        0.010,0.20,74.4\n         a shorter number and no end of line: cut off
        """
        data, start, width = self.data, self.start, len(self.columns)
        tail = 20 * 64 * width  # bytes of the last 20 rows, at 64 a cell
        text = data[max(start, len(data) - tail) :].rstrip(b"\r\n")
        text = (
            text or data[start:].rstrip(b"\r\n")[-tail:]
        )  # only blank lines there: look further up
        lines = [line.decode(errors="replace") for line in text.splitlines()[-20:]]
        *earlier, last = (cells_of(line, self.separator) for line in lines)
        earlier = [row for row in earlier if row]
        widths = [len(row) for row in earlier if len(row) != width]
        if 2 * len(widths) > len(earlier):  # no table, rather than one that is cut off
            rows = f"{len(widths)} of the {len(earlier)} rows before the last one"
            raise LogError(
                f"{rows} have {min(widths)} to {max(widths)} cells",
                where=self.where,
                expected=f"a table: {width} cells in each row, as the header has",
            )
        ended = data.endswith((b"\n", b"\r"))
        short = len(last) < width or lines[-1].count('"') % 2 == 1
        if short or (not ended and self._shorter(last[-1], [row[-1] for row in earlier])):
            flaw = f"the last line is cut off: {lines[-1][:60]!r}"
            raise damaged(self.where, flaw, f"{width} whole cells")
        return None if ended else "no end of line after the last row, which looks complete"

    def _shorter(self, cell: str, earlier: list[str]) -> bool:
        """Whether a last cell looks cut off, which not every cut one does.

        If all earlier cells have the same number of decimals, it has fewer; otherwise it is shorter
        than each of them.
        """
        decimals = [len(c.partition(self.decimal)[2]) for c in (cell, *earlier)]
        if len(set(decimals[1:])) == 1:
            return decimals[0] < decimals[1]
        return bool(earlier) and len(cell) < min(map(len, earlier))

    def read(self, indices: Sequence[int]) -> list[Array]:
        """Some columns as numbers, clocks as seconds. Raises LogError that names a bad row."""
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
            clock_seconds(column.to_pylist(), EMPTY, f"{self.where}: {self.columns[i].name}")
            if i in self.clocks
            else numbers(column)
            for i, column in zip(indices, table.columns, strict=True)
        ]

    def _bad_row(self, cause: str) -> LogError:
        """The error for a row that pyarrow cannot read."""
        if cell := re.search(
            r"column #(\d+): Row #(\d+): .*?invalid value '(.*)'", cause, re.DOTALL
        ):
            mark = {".": "point", ",": "comma"}[self.decimal]
            return LogError(
                f"row {cell[2]}: {cell[3].strip()[:60]!r} is not a number",
                where=f"{self.where}: {self.columns[int(cell[1])].name}",
                expected=f"a number with a decimal {mark}, or an empty cell",
            )
        if row := re.search(r"Row #(\d+): Expected (\d+) columns, got (\d+)", cause):
            return LogError(
                f"row {row[1]} has {row[3]} cells",
                where=self.where,
                expected=f"{row[2]}, as the header has",
                do="look at the row; was the log written by two programs at once?",
            )
        flaw = f"not readable as CSV: {cause[:200]}"
        return LogError(flaw, where=self.where, expected="separated text")

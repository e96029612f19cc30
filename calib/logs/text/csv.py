"""Separated text: the canonical ``name [unit]`` with commas, and the styles of other programs."""

import csv
from collections.abc import Sequence
from typing import Any

import numpy as np

from calib.errors import LogError
from calib.logs.source import Array, Column, ColumnSource
from calib.logs.text.compressed import gunzip
from calib.logs.text.dialect import (
    EMPTY,
    LOOKED,
    SEPARATORS,
    Dialect,
    TextFormat,
    dialect_of,
    is_number,
)
from calib.logs.text.encoding import head_text, to_utf8
from calib.logs.text.header import column_from_cell, is_unit_row, with_unit_row


def open_csv(data: bytes, where: str, text_format: TextFormat = LOOKED) -> ColumnSource:
    """Open a file of separated text.

    Parameters
    ----------
    data : the whole file, compressed by gzip or not.
    where : its path, for messages.
    text_format : separator, decimal mark and encoding from a channel map.

    Raises LogError for a file without text, header or rows, for an ambiguous dialect (see
    `calib.logs.text.dialect`), and for a file that is cut off.
    """
    if data.startswith(b"\x1f\x8b"):
        data = gunzip(data, where)
    data = to_utf8(data, where, text_format.encoding)
    try:
        return _open(data, where, text_format)
    except csv.Error as cause:
        raise LogError(
            f"not a text table: {cause}", where=where, expected="lines of cells"
        ) from cause


def _open(data: bytes, where: str, text_format: TextFormat) -> ColumnSource:
    header, start, text_format = _header(data, where, text_format)
    first, after = _line(data, start)
    has_units = _looks_like_units(first, text_format)
    start = after if has_units else start
    if not data[start : start + 4096].strip() and not data[start:].strip():
        raise LogError("a header and no samples", where=where, expected="at least 50 rows")
    names, note = head_text(header + b"\n" + first if has_units else header, where)
    text, _, units = names.partition("\n")
    dialect = dialect_of(text, data, start, text_format, where)
    (cells,) = dialect.cells([text])
    columns = [column_from_cell(cell) for cell in cells]
    if has_units:
        columns = _with_units(columns, dialect, units, where)
    notes = tuple(n for n in (note, last_row(data, start, len(columns), dialect, where)) if n)

    def read(indices: Sequence[int]) -> list[Array]:
        return read_columns(data, start, tuple(columns), indices, dialect, where)

    return ColumnSource(tuple(columns), read, notes)


def _line(data: bytes, start: int) -> tuple[bytes, int]:
    """The line that begins at ``start``, and the start of the next one. Copies only that line."""
    end = data.find(b"\n", start)
    end = len(data) if end < 0 else end
    return data[start:end].rstrip(b"\r"), end + 1


def _header(data: bytes, where: str, text_format: TextFormat) -> tuple[bytes, int, TextFormat]:
    """The first line, the start of the next one, and the text format.

    A line ``sep=;`` before the header, as spreadsheets use it, gives the separator.
    """
    if not data or data.isspace():
        raise LogError("the file is empty", where=where, expected="a header and samples")
    head, start = _line(data, 0)
    while not head:  # blank lines before it
        head, start = _line(data, start)
    if head[:4].lower() == b"sep=" and head[4:].decode(errors="replace") in SEPARATORS:
        text_format = TextFormat(
            text_format.separator or head[4:].decode(), text_format.decimal, text_format.encoding
        )
        head, start = _line(data, start)
    return head, start, text_format


def _looks_like_units(first: bytes, text_format: TextFormat) -> bool:
    """Whether a line is a second header row with units, for any possible separator."""
    line = first.decode("latin-1")  # never fails, and numbers are the same in it
    separators = [text_format.separator] if text_format.separator else list(SEPARATORS)
    return any(is_unit_row(Dialect(s, ".").cells([line])[0]) for s in separators if s in line)


def _with_units(columns: list[Column], dialect: Dialect, line: str, where: str) -> list[Column]:
    (cells,) = dialect.cells([line])
    if len(cells) != len(columns):
        raise LogError(
            f"{len(cells)} units under {len(columns)} names",
            where=where,
            expected="a unit, or an empty cell, for each name",
        )
    return with_unit_row(columns, cells, where)


def last_row(data: bytes, start: int, width: int, dialect: Dialect, where: str) -> str | None:
    r"""Check the last row: LogError if it is cut off, a note if it has no end of line.

    ``data`` is the whole file; rows have ``width`` cells and begin at ``start``.

    0.005,0.10,74.4800\n
    0.010,0.20,74.4\n         a shorter number and no end of line: cut off
    """
    tail = 40 * 32 * width
    text = data[max(start, len(data) - tail) :].rstrip(b"\r\n")
    text = text or data[start:].rstrip(b"\r\n")[-tail:]  # many blank lines at the end
    lines = text.splitlines()[-20:]
    cells = dialect.cells([line.decode(errors="replace") for line in lines])
    ended = data.endswith((b"\n", b"\r"))
    _refuse_no_table([len(row) for row in cells[:-1] if row], width, where)
    before, last = [row[-1] for row in cells[:-1] if row], cells[-1]
    open_quote = lines[-1].count(b'"') % 2 == 1
    if (
        len(last) < width
        or open_quote
        or (not ended and _shorter(last[-1], before, dialect.decimal))
    ):
        raise LogError(
            f"the last line is cut off: {lines[-1].decode(errors='replace')[:60]!r}",
            where=where,
            expected=f"{width} complete cells",
            do="copy the log again; if the rest is good, delete the last line",
        )
    return None if ended else "no end of line after the last row, which looks complete"


def _refuse_no_table(counts: list[int], width: int, where: str) -> None:
    """Raise LogError if the rows before the last one do not have the cells of the header, either.

    Such a file was not cut off: it is text of another kind.
    """
    wrong = [count for count in counts if count != width]
    if 2 * len(wrong) > len(counts):
        raise LogError(
            f"{len(wrong)} of the {len(counts)} rows before the last one have {min(wrong)} to "
            f"{max(wrong)} cells",
            where=where,
            expected=f"a table: {width} cells in each row, as the header has",
            do="is it text of another kind?",
        )


def _shorter(cell: str, before: list[str], mark: str) -> bool:
    """Whether a number is shorter than all before it.

    Compares the number of decimals if it is the same in all of them, else the length. A cut number
    that is as long as the shortest one before it is not detected.
    """
    if not before:
        return False
    decimals = {len(c.partition(mark)[2]) for c in before}
    if len(decimals) == 1:
        return len(cell.partition(mark)[2]) < min(decimals)
    return len(cell) < min(len(c) for c in before)


def read_columns(
    data: bytes,
    start: int,
    columns: tuple[Column, ...],
    indices: Sequence[int],
    dialect: Dialect,
    where: str,
) -> list[Array]:
    """Read some columns as numbers. After a failure, a second, slow pass locates the bad cell.

    ``data`` is the whole file (a slice would copy it); rows begin at ``start``.

    Raises LogError with row, counted from 1, and column of that cell.
    """
    import pyarrow as pa

    rows = pa.py_buffer(data).slice(start)
    try:
        table = _arrow_table(rows, len(columns), indices, dialect)
    except pa.ArrowInvalid as cause:
        raise _bad_row(data[start:], columns, indices, dialect, where, str(cause)) from cause
    return [
        column.to_numpy().astype(np.float64, copy=False)
        for column in table.columns  # null becomes NaN
    ]


def _arrow_table(rows: Any, width: int, indices: Sequence[int], dialect: Dialect) -> Any:
    import pyarrow as pa
    import pyarrow.csv as arrow_csv

    names = [str(i) for i in range(width)]
    wanted = [str(i) for i in indices]
    return arrow_csv.read_csv(
        pa.BufferReader(rows),
        read_options=arrow_csv.ReadOptions(column_names=names, use_threads=False),
        parse_options=arrow_csv.ParseOptions(delimiter=dialect.separator),
        convert_options=arrow_csv.ConvertOptions(
            include_columns=wanted,
            column_types=dict.fromkeys(wanted, pa.float64()),
            null_values=list(EMPTY),
            decimal_point=dialect.decimal,
        ),
    )


def _bad_row(
    body: bytes,
    columns: tuple[Column, ...],
    indices: Sequence[int],
    dialect: Dialect,
    where: str,
    cause: str,
) -> LogError:
    """Error with row, counted from 1, and column of the first cell that is not a number."""
    for row, cells in enumerate(dialect.cells(body.decode(errors="replace").splitlines()), start=1):
        if cells and len(cells) != len(columns):
            return LogError(
                f"row {row} has {len(cells)} cells",
                where=where,
                expected=f"{len(columns)}, as the header has",
                do="look at the row; was the log written by two programs at once?",
            )
        for index in indices:
            cell = cells[index] if cells else ""
            if cell not in EMPTY and not is_number(cell, dialect.decimal):
                mark = {".": "point", ",": "comma"}[dialect.decimal]
                return LogError(
                    f"row {row}: {cell!r} is not a number",
                    where=f"{where}: {columns[index].name}",
                    expected=f"a number with a decimal {mark}, or an empty cell",
                )
    return LogError(f"not readable as CSV: {cause}", where=where, expected="separated text")

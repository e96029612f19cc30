"""Separated text: our own ``name [unit]`` with commas, and what other programs write."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from calib.errors import LogError
from calib.logs.compressed import gunzip
from calib.logs.dialect import EMPTY, LOOKED, SEPARATORS, Dialect, TextFormat, dialect_of, is_number
from calib.logs.encoding import head_text, to_utf8
from calib.logs.header import column_from_cell, is_unit_row, with_unit_row
from calib.logs.source import Array, Column, Source


def open_csv(data: bytes, where: str, told: TextFormat = LOOKED) -> Source:
    """Open a file of separated text.

    Parameters
    ----------
    data : the whole file, compressed by gzip or not.
    where : its path, for messages.
    told : what a channel map says of its separator, decimal mark and encoding.

    Raises LogError for a file without text, header or rows, for a dialect that is not certain (see
    `calib.logs.dialect`), and for a file that was cut off.
    """
    if data.startswith(b"\x1f\x8b"):
        data = gunzip(data, where)
    data = to_utf8(data, where, told.encoding)
    header, body, told = _split_header(data, where, told)
    first, rest = _first_line(body)
    has_units = _looks_like_units(first, told)
    body = rest if has_units else body
    if not body.strip():
        raise LogError("a header and no samples", where=where, expected="at least 50 rows")
    names, note = head_text(header + b"\n" + first if has_units else header, where)
    text, _, units = names.partition("\n")
    dialect = dialect_of(text, body, told, where)
    (cells,) = dialect.cells([text])
    columns = [column_from_cell(cell) for cell in cells]
    if has_units:
        columns = _with_units(columns, dialect, units, where)
    notes = tuple(n for n in (note, last_row(body, len(columns), dialect, where)) if n)

    def read(indices: Sequence[int]) -> list[Array]:
        return read_columns(body, tuple(columns), indices, dialect, where)

    return Source(tuple(columns), read, notes)


def _first_line(data: bytes) -> tuple[bytes, bytes]:
    head, _, rest = data.partition(b"\n")
    return head.rstrip(b"\r"), rest


def _split_header(data: bytes, where: str, told: TextFormat) -> tuple[bytes, bytes, TextFormat]:
    """The first line, the rest, and what is known of the dialect.

    A line ``sep=;`` before the header, as spreadsheets want it, tells the separator.
    """
    if not data.strip():
        raise LogError("the file is empty", where=where, expected="a header and samples")
    head, body = _first_line(data.lstrip(b"\r\n"))
    if head[:4].lower() == b"sep=" and head[4:].decode(errors="replace") in SEPARATORS:
        told = TextFormat(told.separator or head[4:].decode(), told.decimal, told.encoding)
        head, body = _first_line(body)
    return head, body, told


def _looks_like_units(first: bytes, told: TextFormat) -> bool:
    """Whether a line is a second row of the header, whatever separates it."""
    line = first.decode("latin-1")  # never fails, and numbers are the same in it
    separators = [told.separator] if told.separator else list(SEPARATORS)
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


def last_row(body: bytes, width: int, dialect: Dialect, where: str) -> str | None:
    r"""Look at the last row: raise LogError if it was cut off, note a missing end of line.

    0.005,0.10,74.4800\n
    0.010,0.20,74.4\n         a short number and no end of line: cut
    """
    lines = body.rstrip(b"\r\n")[-40 * 32 * width :].splitlines()[-20:]
    cells = dialect.cells([line.decode(errors="replace") for line in lines])
    ended = body.endswith((b"\n", b"\r"))
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


def _shorter(cell: str, before: list[str], mark: str) -> bool:
    """Whether a number is shorter than all before it: in decimals if these are alike, else as such.

    A number cut after as many digits as its shortest neighbour has is not seen.
    """
    if not before:
        return False
    decimals = {len(c.partition(mark)[2]) for c in before}
    if len(decimals) == 1:
        return len(cell.partition(mark)[2]) < min(decimals)
    return len(cell) < min(len(c) for c in before)


def read_columns(
    body: bytes, columns: tuple[Column, ...], indices: Sequence[int], dialect: Dialect, where: str
) -> list[Array]:
    """Read some columns as numbers; a second, slow look finds the cell that is none.

    Raises LogError naming row, counted from 1, and column of that cell.
    """
    import pyarrow as pa

    try:
        table = _arrow_table(body, len(columns), indices, dialect, pa.float64())
    except pa.ArrowInvalid as cause:
        raise _bad_row(body, columns, indices, dialect, where, str(cause)) from cause
    return [
        column.to_numpy().astype(np.float64, copy=False)
        for column in table.columns  # null becomes NaN
    ]


def _arrow_table(
    body: bytes, width: int, indices: Sequence[int], dialect: Dialect, kind: Any
) -> Any:
    import pyarrow as pa
    import pyarrow.csv as arrow_csv

    names = [str(i) for i in range(width)]
    wanted = [str(i) for i in indices]
    return arrow_csv.read_csv(
        pa.BufferReader(body),
        read_options=arrow_csv.ReadOptions(column_names=names, use_threads=False),
        parse_options=arrow_csv.ParseOptions(delimiter=dialect.separator),
        convert_options=arrow_csv.ConvertOptions(
            include_columns=wanted,
            column_types=dict.fromkeys(wanted, kind),
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
    """Name the row and the column of the first cell that is no number. Rows count from 1."""
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

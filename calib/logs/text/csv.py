"""Separated text: the canonical ``name [unit]`` with commas, and the styles of other programs."""

import csv
import re
from collections.abc import Collection, Sequence
from dataclasses import replace

import numpy as np

from calib.base.errors import LogError
from calib.logs.source import Array, Column, ColumnSource, damaged
from calib.logs.text.cells import (
    clock_seconds,
    column_from_cell,
    is_clock,
    is_unit_row,
    with_more,
    with_unit_row,
)
from calib.logs.text.dialect import (
    EMPTY,
    LOOKED,
    Dialect,
    TextFormat,
    dialect_of,
    is_number,
    layout_of,
    mostly,
    sample_of,
)
from calib.logs.text.encoding import GZIP, gunzip, head_text, to_utf8

FRAME_ID = {"id", "can id", "can_id", "canid", "identifier", "arbitration_id", "arbitration id"}
FRAME_LENGTH = {"dlc", "len", "length", "data", "data length", "d1", "data1", "byte1"}
"""Names of columns, in lower case: a table with one of each has frames in its rows."""


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
    if data.startswith(GZIP):
        data = gunzip(data, where)
    data = to_utf8(data, where, text_format.encoding)
    text = data.rstrip(b"\0")  # a logger that lost its power leaves them
    notes = [f"{len(data) - len(text)} zero bytes at the end were not read"] if text != data else []
    if b"\n" not in text:
        text = text.replace(b"\r", b"\n")
    try:
        source = _open(text, where, text_format)
        return replace(source, notes=(*notes, *source.notes))
    except csv.Error as cause:
        raise LogError(
            f"not a text table: {cause}", where=where, expected="lines of cells"
        ) from cause


def _open(data: bytes, where: str, text_format: TextFormat) -> ColumnSource:
    if not data or data.isspace():
        raise LogError("the file is empty", where=where, expected="a header and samples")
    begin = 0
    told = re.match(rb"\s*sep=([,;\t|])[^\S\r\n]*\r?\n", data, re.IGNORECASE)  # spreadsheets
    if told:
        begin, separator = told.end(), text_format.separator or told[1].decode()
        text_format = replace(text_format, separator=separator)
    layout = layout_of(data, begin, text_format)
    start = layout.start
    if _only_units(data, start, text_format):
        raise LogError("a header and no samples", where=where, expected="at least 50 rows")
    names, note = head_text(b"\n".join((layout.names, layout.units, layout.more)), where)
    dialect = dialect_of(names.partition("\n")[0], data, start, text_format, where)
    cells, units, more = (dialect.cells([line])[0] for line in names.split("\n"))
    columns = [column_from_cell(cell) for cell in cells]
    for row in (units, more):
        if row and len(row) != len(cells):
            what = f"{len(cells)} names, and {len(row)} cells in the header row below"
            raise LogError(what, where=where, expected="a cell, which may be empty, for each name")
    _refuse_frames(columns, where)
    if units:
        columns = with_unit_row(columns, units, where)
    if more:
        columns = [with_more(c, text) for c, text in zip(columns, more, strict=True)]
    rows = dialect.cells(sample_of(data, start))
    clocks = [
        i for i in range(len(columns)) if mostly(is_clock, [r[i] for r in rows if len(r) > i])
    ]
    for i in clocks:
        columns[i] = Column(columns[i].name, "s", columns[i].full or cells[i])
    above = f"{layout.above} lines above the header were not read" if layout.above else ""
    counted = [f"{columns[i].name}: a clock, counted from its first row" for i in clocks]
    end = last_row(data, start, len(columns), dialect, where)
    notes = tuple(n for n in (note, above, *counted, end) if n)

    def read(indices: Sequence[int]) -> list[Array]:
        return read_columns(data, start, tuple(columns), indices, dialect, where, clocks)

    return ColumnSource(tuple(columns), read, notes)


def _only_units(data: bytes, start: int, text_format: TextFormat) -> bool:
    """Whether no row follows, or a row of units only."""
    rest = data[start : start + 65536].strip() or data[start:].strip()
    if b"\n" in rest:
        return False
    line = rest.decode("latin-1")
    possible = text_format.separators
    return not line or any(is_unit_row(Dialect(s, ".").cells([line])[0]) for s in possible)


def _refuse_frames(columns: Sequence[Column], where: str) -> None:
    """Raise LogError for a table of bus frames, as programs for a CAN bus save it."""
    names = {column.name.lower() for column in columns}
    if names & FRAME_ID and names & FRAME_LENGTH:
        raise LogError(
            "the rows are frames of a bus, not samples of channels",
            where=where,
            expected="a column for each channel",
            do="save the frames as BLF, ASC, TRC or `candump -L`, and name a DBC in a channel map",
        )


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
    counts = [len(row) for row in cells[:-1] if row]
    wrong = [count for count in counts if count != width]
    if 2 * len(wrong) > len(counts):  # not cut off: text of another kind
        what = f"{len(wrong)} of the {len(counts)} rows before the last one have"
        raise LogError(
            f"{what} {min(wrong)} to {max(wrong)} cells",
            where=where,
            expected=f"a table: {width} cells in each row, as the header has",
        )
    before, last = [row[-1] for row in cells[:-1] if row], cells[-1]
    shown = lines[-1].decode(errors="replace")
    short = len(last) < width or shown.count('"') % 2 == 1
    if short or (not ended and _shorter(last[-1], before, dialect.decimal)):
        raise damaged(where, f"the last line is cut off: {shown[:60]!r}", f"{width} whole cells")
    return None if ended else "no end of line after the last row, which looks complete"


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
    clocks: Collection[int] = (),
) -> list[Array]:
    """Read some columns as numbers. After a failure, a second, slow pass locates the bad cell.

    ``data`` is the whole file (a slice would copy it); rows begin at ``start``; ``clocks`` are the
    columns that hold times of day, which are read as seconds.

    Raises LogError with row, counted from 1, and column of that cell.
    """
    import pyarrow as pa
    import pyarrow.csv as arrow_csv

    types = {str(i): pa.string() if i in clocks else pa.float64() for i in indices}
    try:
        table = arrow_csv.read_csv(
            pa.BufferReader(pa.py_buffer(data).slice(start)),
            read_options=arrow_csv.ReadOptions(
                column_names=[str(i) for i in range(len(columns))], use_threads=False
            ),
            parse_options=arrow_csv.ParseOptions(delimiter=dialect.separator),
            convert_options=arrow_csv.ConvertOptions(
                include_columns=list(map(str, indices)),
                column_types=types,
                null_values=list(EMPTY),
                decimal_point=dialect.decimal,
            ),
        )
    except pa.ArrowInvalid as cause:
        numbers = [i for i in indices if i not in clocks]
        raise _bad_row(data[start:], columns, numbers, dialect, where, str(cause)) from cause
    return [
        clock_seconds(column.to_pylist(), EMPTY, f"{where}: {columns[i].name}")
        if i in clocks
        else column.to_numpy().astype(np.float64, copy=False)  # null becomes NaN
        for i, column in zip(indices, table.columns, strict=True)
    ]


def _bad_row(
    body: bytes,
    columns: tuple[Column, ...],
    indices: Sequence[int],
    dialect: Dialect,
    where: str,
    cause: str,
) -> LogError:
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

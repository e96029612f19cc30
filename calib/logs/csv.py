"""Comma-separated text with header cells ``name [unit]``."""

import csv
import re
from collections.abc import Sequence
from typing import Any

import numpy as np

from calib.errors import LogError
from calib.logs.source import Array, Column, Source, column_from_cell

EMPTY = ("", "nan", "NaN", "NAN", "NA", "N/A", "null")
"""Cells that mean: no value here."""


def open_csv(data: bytes, where: str) -> Source:
    """Open a CSV file.

    Parameters
    ----------
    data : the whole file.
    where : its path, for messages.

    Raises LogError for a file without text, header or rows, with another delimiter than a comma,
    or with rows of uneven length (a truncated last line among them).
    """
    header, body = _split_header(data, where)
    cells = next(csv.reader([header]))
    _refuse_other_delimiter(header, cells, where)
    columns = tuple(column_from_cell(cell) for cell in cells)
    if not body.strip():
        raise LogError("a header and no samples", where=where, expected="at least 50 rows")
    notes = _check_end(body, len(columns), where)

    def read(indices: Sequence[int]) -> list[Array]:
        return _read_columns(body, columns, indices, where)

    return Source(columns, read, notes)


def _split_header(data: bytes, where: str) -> tuple[str, bytes]:
    """The first line as text, and the rest."""
    if not data.strip():
        raise LogError("the file is empty", where=where, expected="a header and samples")
    if b"\0" in data[:4096]:
        raise LogError("not text", where=where, expected="comma-separated text")
    head, _, body = data.lstrip(b"\r\n").partition(b"\n")
    try:
        return head.decode("utf-8-sig").rstrip("\r"), body
    except UnicodeDecodeError:  # an old logger's degree sign
        return head.decode("latin-1").rstrip("\r"), body


def _refuse_other_delimiter(header: str, cells: list[str], where: str) -> None:
    for sign, name in ((";", "semicolon"), ("\t", "tab"), ("|", "vertical bar")):
        if header.count(sign) >= len(cells):
            raise LogError(
                f"the columns are separated by a {name} ({sign!r})",
                where=where,
                expected="a comma between columns and a point in numbers",
                do="export the log again, or replace the delimiter (and decimal commas)",
            )


def _check_end(body: bytes, width: int, where: str) -> tuple[str, ...]:
    r"""Refuse a file whose last line was cut off.

    0.005,0.10,74.4800\n
    0.010,0.20,74.4\n         a short number and no end of line: cut
    """
    lines = body.rstrip(b"\r\n")[-40 * 32 * width :].splitlines()[-20:]
    cells = [line.split(b",") for line in lines]
    ended = body.endswith((b"\n", b"\r"))
    decimals = {_decimals(row[-1]) for row in cells[:-1] if row}
    short = len(decimals) == 1 and _decimals(cells[-1][-1]) < min(decimals)
    if len(cells[-1]) < width or (not ended and short):
        raise LogError(
            f"the last line is cut off: {lines[-1].decode(errors='replace')[:60]!r}",
            where=where,
            expected=f"{width} complete cells",
            do="copy the log again; if the rest is good, delete the last line",
        )
    return () if ended else ("no end of line after the last row, which looks complete",)


def _decimals(cell: bytes) -> int:
    return len(cell.strip().partition(b".")[2])


def _read_columns(
    body: bytes, columns: tuple[Column, ...], indices: Sequence[int], where: str
) -> list[Array]:
    """Read some columns as numbers; a second, slow look finds the cell that is none."""
    import pyarrow as pa

    try:
        table = _arrow_table(body, len(columns), indices, pa.float64())
    except pa.ArrowInvalid as cause:
        raise _bad_row(body, columns, indices, where, str(cause)) from cause
    return [
        column.to_numpy().astype(np.float64, copy=False)
        for column in table.columns  # null becomes NaN
    ]


def _arrow_table(body: bytes, width: int, indices: Sequence[int], kind: Any) -> Any:
    import pyarrow as pa
    import pyarrow.csv as arrow_csv

    names = [str(i) for i in range(width)]
    wanted = [str(i) for i in indices]
    return arrow_csv.read_csv(
        pa.BufferReader(body),
        read_options=arrow_csv.ReadOptions(column_names=names, use_threads=False),
        convert_options=arrow_csv.ConvertOptions(
            include_columns=wanted,
            column_types=dict.fromkeys(wanted, kind),
            null_values=list(EMPTY),
        ),
    )


def _bad_row(
    body: bytes, columns: tuple[Column, ...], indices: Sequence[int], where: str, cause: str
) -> LogError:
    """Name the row and the column of the first cell that is no number. Rows count from 1."""
    text = body.decode("utf-8", errors="replace").splitlines()
    for row, cells in enumerate(csv.reader(text), start=1):
        if cells and len(cells) != len(columns):
            return LogError(
                f"row {row} has {len(cells)} cells",
                where=where,
                expected=f"{len(columns)}, as the header has",
                do="look at the row; was the log written by two programs at once?",
            )
        for index in indices:
            cell = cells[index].strip() if cells else ""
            if cell not in EMPTY and not _is_number(cell):
                return LogError(
                    f"row {row}: {cell!r} is not a number",
                    where=f"{where}: {columns[index].name}",
                    expected="a number with a decimal point, or an empty cell",
                )
    return LogError(f"not readable as CSV: {cause}", where=where, expected="comma-separated text")


_NUMBER = re.compile(r"[-+]?(\d+\.?\d*|\.\d+)([eE][-+]?\d+)?|[-+]?inf(inity)?", re.IGNORECASE)


def _is_number(cell: str) -> bool:
    return _NUMBER.fullmatch(cell) is not None

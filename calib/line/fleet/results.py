"""`results.parquet`: one row for each log, sorted by log; equal rows give equal bytes.

The columns are in `calib.line.fleet.columns`. The file is written in groups of rows and read
column by column, so that a large fleet needs little memory.
"""

import itertools
import os
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.base.bounded import RESULT, open_bounded
from calib.base.errors import InputError
from calib.base.toml import did_you_mean
from calib.line.fleet.columns import COLUMNS, HEAD, ColumnKind, ResultColumn, Status
from calib.line.fleet.command import Command
from calib.line.fleet.line_order import is_unknown, line_order
from calib.line.fleet.row import Row

Array = NDArray[np.float64]

NAME = "results.parquet"
GROUP = 5000
"""Number of rows in memory at a time."""

EXPECTED = "results.parquet of `brake-cal batch`"


def write_results(rows: Iterable[Row], settings: dict[str, str], folder: Path) -> Path:
    """Write the rows in their order and return the path; an old file is replaced at the end.

    Units and meanings are in the metadata of the fields, the settings in that of the file.
    Raises OSError if the folder cannot be written.
    """
    import pyarrow.parquet as pq

    columns = (*HEAD, *COLUMNS[Command(settings["command"])])
    schema = _schema_of(columns, settings)
    path, new = folder / NAME, folder / f".{NAME}.new"
    rest = iter(rows)
    try:
        with pq.ParquetWriter(new, schema, compression="zstd") as writer:
            while group := list(itertools.islice(rest, GROUP)):
                writer.write_table(_table(group, columns, schema))
        with open(new, "rb") as file:
            os.fsync(file.fileno())
        os.replace(new, path)
    finally:
        new.unlink(missing_ok=True)
    return path


def _schema_of(columns: tuple[ResultColumn, ...], settings: dict[str, str]) -> Any:
    import pyarrow as pa

    types = {
        ColumnKind.NUMBER: pa.float64(),
        ColumnKind.YES_NO: pa.bool_(),
        ColumnKind.TEXT: pa.string(),
    }
    fields = [
        pa.field(c.name, types[c.kind], metadata={"unit": c.unit, "meaning": c.meaning})
        for c in columns
    ]
    return pa.schema(fields, metadata={f"brake_cal.{k}": v for k, v in settings.items()})


def _table(rows: list[Row], columns: tuple[ResultColumn, ...], schema: Any) -> Any:
    import pyarrow as pa

    none = (None,) * (len(columns) - len(HEAD))
    full = [(r.log, r.digest, r.status, r.error, *(r.cells or none)) for r in rows]
    arrays = [
        pa.array(values, type=field.type)
        for values, field in zip(zip(*full, strict=True), schema, strict=True)
    ]
    return pa.Table.from_arrays(arrays, schema=schema)


@dataclass(frozen=True)
class FleetFile:
    """An open results file: its ``logs`` and columns of ``metrics``; values are read on demand.

    ``order``: row indices in the order of the line, (n,); ``ordered_by`` names this order;
    ``columns``: names of all.
    """

    path: Path
    logs: tuple[str, ...]
    columns: tuple[str, ...]
    metrics: tuple[ResultColumn, ...]
    order: NDArray[np.int64]
    ordered_by: str

    def numbers(self, name: str) -> Array:
        """A column of numbers in the order of the line, (n,); NaN if a log has none."""
        column = _column(self.path, name).cast("float64")
        return np.asarray(column.to_numpy(zero_copy_only=False), dtype=np.float64)[self.order]

    def values(self, name: str) -> tuple[str | bool | None, ...]:
        """A column of text or of yes and no in the order of the line."""
        values = _column(self.path, name).to_pylist()
        return tuple(values[i] for i in self.order)


def open_fleet(path: Path, order: str | None = None) -> FleetFile:
    """Open the results of a batch.

    ``order`` is the column that orders the line; None for the logs' names.

    Raises InputError for another file, an unknown status, or an unknown column.
    """
    with _opened(path) as file:
        schema = file.schema_arrow
    missing = [name for name in ("log", "status", "error") if name not in schema.names]
    if missing:
        raise InputError(f"no column {missing[0]!r}", where=path, expected=EXPECTED)
    logs = [str(name) for name in _column(path, "log").to_pylist()]
    if not logs:
        raise InputError("the file has no rows", where=path, expected="one row for each log")
    odd = sorted({str(s) for s in _column(path, "status").to_pylist()} - {*Status})
    if odd:
        raise InputError(f"status {odd[0]!r}", where=path, expected=", ".join(Status))
    rows, ordered_by = _ordered(path, order, logs, schema.names)
    head = {column.name for column in HEAD}
    metrics = tuple(_column_of(field) for field in schema if field.name not in head)
    return FleetFile(
        path=path,
        logs=tuple(logs[i] for i in rows),
        columns=tuple(schema.names),
        metrics=metrics,
        order=np.asarray(rows),
        ordered_by=ordered_by,
    )


def _ordered(
    path: Path, order: str | None, logs: list[str], columns: list[str]
) -> tuple[list[int], str]:
    """Row indices in the order of the line, and the name of that order."""
    if order is None or order == "log":
        return line_order(logs), "the logs' names"
    if order not in columns:
        raise InputError(
            f"no column {order!r}",
            where=path,
            expected=f"one of {', '.join(columns)}",
            do=did_you_mean(order, columns),
        )
    values = _column(path, order).to_pylist()
    unknown = sum(map(is_unknown, values))
    rest = f" ({unknown} rows without it at the end)" if unknown else ""
    return line_order(values), order + rest


@contextmanager
def _opened(path: Path) -> Iterator[Any]:
    """Open the file. Raises InputError if it is missing, not Parquet, or cut off."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        opened = open_bounded(path, RESULT)
    except FileNotFoundError as cause:
        raise InputError("no such file", where=path, expected=EXPECTED) from cause
    except OSError as cause:
        raise InputError(
            f"cannot be read ({cause.strerror})", where=path, expected=EXPECTED
        ) from cause
    try:
        # pyarrow cannot open paths that are not UTF-8
        with opened, pq.ParquetFile(opened) as file:
            yield file
    except (pa.ArrowInvalid, OSError) as cause:
        raise InputError("not a Parquet file, or cut off", where=path) from cause


def _column(path: Path, name: str) -> Any:
    with _opened(path) as file:
        # Without threads: a thread pool that still runs at exit aborts a short program.
        return file.read(columns=[name], use_threads=False).column(0).combine_chunks()


def _column_of(field: Any) -> ResultColumn:
    """A column from the file's schema; integers are numbers, and unknown types are text."""
    import pyarrow.types as types

    metadata = {key.decode(): value.decode() for key, value in (field.metadata or {}).items()}
    number = types.is_floating(field.type) or types.is_integer(field.type)
    other = ColumnKind.YES_NO if types.is_boolean(field.type) else ColumnKind.TEXT
    kind = ColumnKind.NUMBER if number else other
    return ResultColumn(field.name, kind, metadata.get("unit", "1"), metadata.get("meaning", ""))

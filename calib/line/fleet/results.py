"""Write and read `results.parquet`: one row for each log, columns as in `calib.line.fleet.rows`."""

import itertools
import re
from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from calib.base.arrays import Array
from calib.base.bounded import RESULT, bytes_of
from calib.base.errors import InputError
from calib.base.plain import metric_of
from calib.base.write import write_whole
from calib.line.fleet.rows import HEAD, Column, Command, Row, Status, columns_of
from calib.logs.parquet import parquet_table

NAME = "results.parquet"
_GROUP = 5000  # number of rows in memory at a time
_EXPECTED = "results.parquet of `brake-cal batch`"


def write_results(rows: Iterable[Row], settings: dict[str, str], folder: Path) -> None:
    """Write the rows in their order, completely or not at all; equal rows give equal bytes.

    The metadata of a column holds unit and meaning of the column, that of the file the settings.
    Raises OSError if the folder cannot be written.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    command = Command(settings["command"])
    types = {float: pa.float64(), bool: pa.bool_(), str: pa.string()}
    fields = []
    for column in (*HEAD, *columns_of(command)):
        metadata = {"unit": column.unit, "meaning": metric_of(column.name).name}
        fields.append(pa.field(column.name, types[column.kind], metadata=metadata))
    schema = pa.schema(fields, metadata={f"brake_cal.{k}": v for k, v in settings.items()})
    cells = (row.head() | row.metrics(command) for row in rows)
    content = pa.BufferOutputStream()
    with pq.ParquetWriter(content, schema, compression="zstd") as writer:
        while group := list(itertools.islice(cells, _GROUP)):
            writer.write_table(pa.Table.from_pylist(group, schema=schema))
    write_whole(folder / NAME, content.getvalue().to_pybytes())


@dataclass(frozen=True)
class FleetFile:
    """Results of n logs in the order of their names, where log10 follows log9."""

    logs: tuple[str, ...]
    metrics: tuple[Column, ...]  # all columns but those of `HEAD`
    table: Any  # the Arrow table with all columns

    def numbers(self, name: str) -> Array:
        """Return a column of numbers, (n,); NaN for a log without a number."""
        return np.asarray(self.table.column(name).cast("float64").to_numpy(), dtype=np.float64)

    def values(self, name: str) -> tuple[str | None, ...]:
        """Return the n texts of a column; () without such a column."""
        exists = name in self.table.column_names
        return tuple(self.table.column(name).to_pylist()) if exists else ()


def open_fleet(path: Path) -> FleetFile:
    """Read the results of a batch. Raises InputError for another file, or an unknown status."""
    data = bytes_of(path, RESULT, InputError, _EXPECTED)
    try:
        table = parquet_table(data)
    except ValueError as cause:
        raise InputError("not a Parquet file, or cut off", where=path) from cause
    for name in ("log", "status", "error"):
        if name not in table.column_names:
            raise InputError(f"no column {name!r}", where=path, expected=_EXPECTED)
    statuses = {str(status) for status in table.column("status").to_pylist()}
    unknown = sorted(statuses - {*Status})
    if unknown:
        raise InputError(f"status {unknown[0]!r}", where=path, expected=", ".join(Status))
    if not statuses:
        raise InputError("no rows", where=path, expected=_EXPECTED)
    logs = [str(log) for log in table.column("log").to_pylist()]
    order = sorted(range(len(logs)), key=lambda row: _natural(logs[row]))
    head = {column.name for column in HEAD}
    return FleetFile(
        logs=tuple(logs[row] for row in order),
        metrics=tuple(_column_of(field) for field in table.schema if field.name not in head),
        table=table.take(order),
    )


def _natural(text: str) -> list[str | int]:
    """Return a key that sorts texts by the numbers in them: "car9" before "car10"."""
    return [int(part) if part.isdecimal() else part for part in re.split(r"(\d+)", text)]


def _column_of(field: Any) -> Column:
    """Return the column of a field of the Arrow schema; a field of another type is text."""
    import pyarrow.types as types

    unit = (field.metadata or {}).get(b"unit", b"1").decode()
    kind: type = str
    if types.is_floating(field.type) or types.is_integer(field.type):
        kind = float
    elif types.is_boolean(field.type):
        kind = bool
    return Column(field.name, unit, kind)

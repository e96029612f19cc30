"""`results.parquet`: one row for each log, sorted by log; equal rows give equal bytes.

The columns are in `calib.line.fleet.rows`. Rows are written in groups, so that a large fleet needs
little memory.
"""

import itertools
import os
import re
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from calib.base.bounded import RESULT, open_bounded
from calib.base.errors import InputError
from calib.base.toml import did_you_mean
from calib.base.write import sync
from calib.line.fleet.rows import HEAD, ColumnKind, Command, ResultColumn, Row, Status, columns_of
from calib.logs.log import Array

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

    schema = _schema_of((*HEAD, *columns_of(Command(settings["command"]))), settings)
    path, new = folder / NAME, folder / f".{NAME}.new"
    rest = iter(rows)
    try:
        with pq.ParquetWriter(new, schema, compression="zstd") as writer:
            while group := list(itertools.islice(rest, GROUP)):
                writer.write_table(_table(group, schema))
        sync(new)
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


def _table(rows: list[Row], schema: Any) -> Any:
    import pyarrow as pa

    none = (None,) * (len(schema) - len(HEAD))
    full = [(r.log, r.digest, r.status, r.error, *(r.cells or none)) for r in rows]
    columns = zip(zip(*full, strict=True), schema, strict=True)
    arrays = [pa.array(values, type=field.type) for values, field in columns]
    return pa.Table.from_arrays(arrays, schema=schema)


@dataclass(frozen=True)
class FleetFile:
    """A results file in the order of the line, which ``ordered_by`` names.

    ``logs`` (n,); ``columns`` names of all; ``metrics`` those after the first ones; ``table`` a
    table of pyarrow.
    """

    path: Path
    table: Any
    ordered_by: str

    @property
    def logs(self) -> tuple[str, ...]:
        """Names of the logs."""
        return tuple(map(str, self.values("log")))

    @property
    def columns(self) -> tuple[str, ...]:
        """Names of all columns."""
        return tuple(self.table.column_names)

    @property
    def metrics(self) -> tuple[ResultColumn, ...]:
        """All columns but the first ones."""
        head = {column.name for column in HEAD}
        return tuple(_column_of(field) for field in self.table.schema if field.name not in head)

    def numbers(self, name: str) -> Array:
        """A column of numbers, (n,); NaN if a log has none."""
        column = self.table.column(name).cast("float64").combine_chunks()
        return np.asarray(column.to_numpy(zero_copy_only=False), dtype=np.float64)

    def values(self, name: str) -> tuple[str | bool | None, ...]:
        """A column of text or of yes and no."""
        return tuple(self.table.column(name).to_pylist())


def open_fleet(path: Path, order: str | None = None) -> FleetFile:
    """Read the results of a batch.

    ``order`` is the column that orders the line; None for the logs' names.

    Raises InputError for another file, an unknown status, or an unknown column.
    """
    table = _read(path)
    for name in ("log", "status", "error"):
        if name not in table.column_names:
            raise InputError(f"no column {name!r}", where=path, expected=EXPECTED)
    if not table.num_rows:
        raise InputError("the file has no rows", where=path, expected="one row for each log")
    odd = sorted(set(map(str, table.column("status").to_pylist())) - {*Status})
    if odd:
        raise InputError(f"status {odd[0]!r}", where=path, expected=", ".join(Status))
    order = order or "log"
    if order not in table.column_names:
        raise InputError(
            f"no column {order!r}",
            where=path,
            expected=f"one of {', '.join(table.column_names)}",
            do=did_you_mean(order, table.column_names),
        )
    values = table.column(order).to_pylist()
    unknown = sum(map(_is_unknown, values))
    rest = f" ({unknown} rows without it at the end)" if unknown else ""
    ordered_by = "the logs' names" if order == "log" else order + rest
    return FleetFile(path, table.take(line_order(values)), ordered_by)


def line_order(values: Sequence[object]) -> list[int]:
    """Indices that sort ``values``, text in natural order; unknown values go to the end.

    >>> line_order(["car10", "car9", None, "car1"])
    [3, 1, 0, 2]
    """
    return sorted(range(len(values)), key=lambda i: (_is_unknown(values[i]), _key(values[i])))


def _is_unknown(value: object) -> bool:
    return value is None or value != value


def _key(value: object) -> Any:
    if _is_unknown(value):
        return 0
    if not isinstance(value, str):
        return value
    parts = re.split(r"(\d+)", value)
    return [(1, int(p), "") if p.isdecimal() else (0, 0, p) for p in parts]


def _read(path: Path) -> Any:
    """The whole table. Raises InputError if it is missing, not Parquet, or cut off."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        opened = open_bounded(path, RESULT)
    except OSError as cause:
        what = (
            "no such file"
            if isinstance(cause, FileNotFoundError)
            else f"cannot be read ({cause.strerror})"
        )
        raise InputError(what, where=path, expected=EXPECTED) from cause
    try:
        # pyarrow cannot open paths that are not UTF-8
        with opened, pq.ParquetFile(opened) as file:
            # without threads: a thread pool that still runs at exit aborts a short program
            return file.read(use_threads=False)
    except (pa.ArrowInvalid, OSError) as cause:
        raise InputError("not a Parquet file, or cut off", where=path) from cause


def _column_of(field: Any) -> ResultColumn:
    """A column from the file's schema; integers are numbers, and unknown types are text."""
    import pyarrow.types as types

    metadata = {key.decode(): value.decode() for key, value in (field.metadata or {}).items()}
    number = types.is_floating(field.type) or types.is_integer(field.type)
    other = ColumnKind.YES_NO if types.is_boolean(field.type) else ColumnKind.TEXT
    kind = ColumnKind.NUMBER if number else other
    return ResultColumn(field.name, kind, metadata.get("unit", "1"), metadata.get("meaning", ""))

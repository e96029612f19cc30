"""`results.parquet`: one row for each log, with the columns of `calib.line.fleet.rows`."""

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

NAME = "results.parquet"
_GROUP = 5000
"""Number of rows in memory at a time."""
_EXPECTED = "results.parquet of `brake-cal batch`"


def write_results(rows: Iterable[Row], settings: dict[str, str], folder: Path) -> None:
    """Write the rows in their order; an old file is replaced at the end.

    Units and meanings are in the metadata of the fields, the settings in that of the file; equal
    rows give equal bytes. Raises OSError if the folder cannot be written.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    command = Command(settings["command"])
    types = {float: pa.float64(), bool: pa.bool_(), str: pa.string()}
    fields = [
        pa.field(
            c.name, types[c.kind], metadata={"unit": c.unit, "meaning": metric_of(c.name).name}
        )
        for c in (*HEAD, *columns_of(command))
    ]
    schema = pa.schema(fields, metadata={f"brake_cal.{k}": v for k, v in settings.items()})
    cells, written = (row.head() | row.metrics(command) for row in rows), pa.BufferOutputStream()
    with pq.ParquetWriter(written, schema, compression="zstd") as writer:
        while group := list(itertools.islice(cells, _GROUP)):
            writer.write_table(pa.Table.from_pylist(group, schema=schema))
    write_whole(folder / NAME, written.getvalue().to_pybytes())


@dataclass(frozen=True)
class FleetFile:
    """Results in the natural order of the logs' names.

    ``logs`` (n,) names; ``metrics`` the columns after the first ones.
    """

    logs: tuple[str, ...]
    metrics: tuple[Column, ...]
    table: Any

    def numbers(self, name: str) -> Array:
        """A column of numbers, (n,); NaN if a log has none."""
        return np.asarray(self.table.column(name).cast("float64").to_numpy(), dtype=np.float64)

    def values(self, name: str) -> tuple[str | None, ...]:
        """A column of text; () if there is none."""
        exists = name in self.table.column_names
        return tuple(self.table.column(name).to_pylist()) if exists else ()


def open_fleet(path: Path) -> FleetFile:
    """Read the results of a batch. Raises InputError for another file, or an unknown status."""
    table = _read(path)
    for name in ("log", "status", "error"):
        if name not in table.column_names:
            raise InputError(f"no column {name!r}", where=path, expected=_EXPECTED)
    unknown = sorted(set(map(str, table.column("status").to_pylist())) - {*Status})
    if unknown or not table.num_rows:
        problem = f"status {unknown[0]!r}" if unknown else "no rows"
        raise InputError(problem, where=path, expected=f"rows with {', '.join(Status)}")
    logs = [str(log) for log in table.column("log").to_pylist()]
    order = sorted(range(len(logs)), key=lambda row: _natural(logs[row]))
    head = {column.name for column in HEAD}
    return FleetFile(
        tuple(logs[row] for row in order),
        tuple(_column_of(field) for field in table.schema if field.name not in head),
        table.take(order),
    )


def _natural(text: str) -> list[tuple[int, int, str]]:
    """Key that sorts by the numbers in a text.

    >>> sorted(["car10", "car9", "car1"], key=_natural)
    ['car1', 'car9', 'car10']
    """
    parts = re.split(r"(\d+)", text)
    return [(1, int(p), "") if p.isdecimal() else (0, 0, p) for p in parts]


def _read(path: Path) -> Any:
    """The whole table. Raises InputError if it is missing, not Parquet, or cut off."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    data = bytes_of(path, RESULT, InputError, _EXPECTED)
    try:
        # without threads: a thread pool that still runs at exit aborts a short program
        return pq.ParquetFile(pa.BufferReader(data)).read(use_threads=False)
    except (pa.ArrowInvalid, OSError) as cause:
        raise InputError("not a Parquet file, or cut off", where=path) from cause


def _column_of(field: Any) -> Column:
    """A column from the file's schema; integers are numbers, and unknown types are text."""
    import pyarrow.types as types

    unit = (field.metadata or {}).get(b"unit", b"1").decode()
    number = types.is_floating(field.type) or types.is_integer(field.type)
    return Column(
        field.name, unit, float if number else bool if types.is_boolean(field.type) else str
    )

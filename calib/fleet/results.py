"""`results.parquet`: one row a log, sorted by log, the same bytes however they were made."""

import itertools
import os
from collections.abc import Iterable
from pathlib import Path
from typing import Any

from calib.fleet.columns import COLUMNS, HEAD, ResultColumn
from calib.fleet.row import Row

NAME = "results.parquet"
GROUP = 5000
"""Rows that are held at a time."""


def write_results(rows: Iterable[Row], settings: dict[str, str], folder: Path) -> Path:
    """Write the rows, in their order, and return the path; the old file stays until it is whole.

    Units and meanings stand in the metadata of the fields, the settings in that of the file.
    Raises OSError if the folder cannot be written.
    """
    import pyarrow.parquet as pq

    columns = (*HEAD, *COLUMNS[settings["command"]])
    schema = _schema(columns, settings)
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


def _schema(columns: tuple[ResultColumn, ...], settings: dict[str, str]) -> Any:
    import pyarrow as pa

    kinds = {"float": pa.float64(), "bool": pa.bool_(), "text": pa.string()}
    fields = [
        pa.field(c.name, kinds[c.kind], metadata={"unit": c.unit, "meaning": c.meaning})
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

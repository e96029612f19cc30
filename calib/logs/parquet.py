"""Parquet with each channel's unit in the field metadata, under the key ``unit``."""

import json
from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from calib.errors import LogError
from calib.files.bounded import LOG
from calib.logs.source import Array, Column, ColumnSource
from calib.logs.text.compressed import too_large
from calib.logs.text.header import column_from_cell

if TYPE_CHECKING:
    import pyarrow

UNIT_KEY = b"unit"
OTHER_KEYS = (b"units", b"Unit", b"Units")
"""Other keys of the field metadata for the unit."""
MDF_CLOCK = "timestamps"
"""Name of the time index of a table exported by asammdf, in seconds."""


def open_parquet(data: bytes, where: str, text_format: object = None) -> ColumnSource:
    """Open a Parquet file.

    A field without the metadata may have its unit in its name, as in CSV: ``p_mc [bar]``. Files
    from pandas need this, because pandas drops the metadata, or the units by column in
    ``frame.attrs["units"]``. The index ``timestamps`` of a file exported by asammdf is the time in
    seconds; asammdf drops all other units, so they must be in a channel map. ``text_format`` is not
    used.

    Raises LogError for a file that is empty, cut off or not Parquet.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    if not data:
        raise LogError("the file is empty", where=where, expected="a Parquet file")
    try:
        file = pq.ParquetFile(pa.BufferReader(data), page_checksum_verification=True)
        schema = file.schema_arrow
        fields = list(schema)  # names that are not UTF-8 are decoded here
    except (pa.ArrowException, OSError, ValueError) as cause:
        raise LogError(
            f"not Parquet, or cut off: {cause}",
            where=where,
            expected="a complete Parquet file",
            do="copy the log again",
        ) from cause
    pandas = _pandas(schema.metadata)
    columns = tuple(_column(field, pandas) for field in fields)
    if file.metadata.num_rows == 0:
        raise LogError("a header and no samples", where=where, expected="at least 50 rows")
    groups = (file.metadata.row_group(i) for i in range(file.metadata.num_row_groups))
    unpacked = sum(group.total_byte_size for group in groups)
    if max(unpacked, 8 * file.metadata.num_rows * len(columns)) > LOG.most:
        raise too_large(where)

    def read(indices: Sequence[int]) -> list[Array]:
        try:
            table = file.read(use_threads=False)
        except (pa.ArrowException, OSError, ValueError) as cause:
            raise LogError(f"damaged: {cause}", where=where, do="copy the log again") from cause
        return [_numbers(table.column(i), f"{where}: {columns[i].name}") for i in indices]

    return ColumnSource(columns, read)


def _pandas(metadata: dict[bytes, bytes] | None) -> dict[str, Any]:
    """The metadata of pandas; empty if another program wrote the file.

    pandas 2 writes ``frame.attrs`` beside it, pandas 3 with a new pyarrow into it.
    """
    found = _object(metadata, b"pandas")
    attributes = found.get("attributes") or _object(metadata, b"PANDAS_ATTRS")
    return {**found, "attributes": attributes}


def _object(metadata: dict[bytes, bytes] | None, key: bytes) -> dict[str, Any]:
    try:
        found = json.loads((metadata or {}).get(key, b"{}"))
    except ValueError:
        return {}
    return found if isinstance(found, dict) else {}


def _column(field: "pyarrow.Field", pandas: dict[str, Any]) -> Column:
    metadata = field.metadata or {}
    for key in (UNIT_KEY, *OTHER_KEYS):
        if key in metadata:
            return Column(field.name, metadata[key].decode(errors="replace"))
    if field.name == MDF_CLOCK and MDF_CLOCK in pandas.get("index_columns", []):
        return Column("time", "s", MDF_CLOCK)
    units = (pandas.get("attributes") or {}).get("units")
    unit = units.get(field.name) if isinstance(units, dict) else None
    return Column(field.name, str(unit)) if unit else column_from_cell(field.name)


def _numbers(column: "pyarrow.ChunkedArray", where: str) -> Array:
    import pyarrow as pa

    try:
        values: Array = column.cast(pa.float64()).to_numpy().astype(np.float64, copy=False)
    except (pa.ArrowException, ValueError) as cause:
        raise LogError(
            f"holds {column.type}, not numbers", where=where, expected="a numeric column"
        ) from cause
    return values

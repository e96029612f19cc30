"""Parquet with each channel's unit in the field metadata, under the key ``unit``."""

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from calib.errors import LogError
from calib.logs.header import column_from_cell
from calib.logs.source import Array, Column, Source

if TYPE_CHECKING:
    import pyarrow

UNIT_KEY = b"unit"


def open_parquet(data: bytes, where: str, told: object = None) -> Source:
    """Open a Parquet file.

    A field without the metadata may name its unit as a CSV header does, ``p_mc [bar]``; that is
    what is left when pandas has written the file, since pandas drops the metadata.

    Raises LogError for a file that is empty, cut off or not Parquet.
    """
    import pyarrow as pa
    import pyarrow.parquet as pq

    if not data:
        raise LogError("the file is empty", where=where, expected="a Parquet file")
    try:
        file = pq.ParquetFile(pa.BufferReader(data), page_checksum_verification=True)
    except (pa.ArrowInvalid, OSError) as cause:
        raise LogError(
            f"not Parquet, or cut off: {cause}",
            where=where,
            expected="a whole Parquet file",
            do="copy the log again",
        ) from cause
    columns = tuple(_column(field) for field in file.schema_arrow)
    if file.metadata.num_rows == 0:
        raise LogError("a header and no samples", where=where, expected="at least 50 rows")

    def read(indices: Sequence[int]) -> list[Array]:
        try:
            table = file.read(use_threads=False)
        except (pa.ArrowInvalid, OSError) as cause:
            raise LogError(f"damaged: {cause}", where=where, do="copy the log again") from cause
        return [_numbers(table.column(i), f"{where}: {columns[i].name}") for i in indices]

    return Source(columns, read)


def _column(field: "pyarrow.Field") -> Column:
    unit = (field.metadata or {}).get(UNIT_KEY)
    return Column(field.name, unit.decode()) if unit is not None else column_from_cell(field.name)


def _numbers(column: "pyarrow.ChunkedArray", where: str) -> Array:
    import pyarrow as pa

    try:
        values: Array = column.cast(pa.float64()).to_numpy().astype(np.float64, copy=False)
    except (pa.ArrowInvalid, pa.ArrowNotImplementedError) as cause:
        raise LogError(
            f"holds {column.type}, not numbers", where=where, expected="a numeric column"
        ) from cause
    return values

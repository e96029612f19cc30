"""Parquet: one row per number (`calib.exports.rows`); the facts of the table as metadata."""

from calib.exports.dataset import Dataset
from calib.exports.rows import COLUMNS, rows

TEXTS = ("label", "axis", "unit", "meaning")
"""Columns of text; all others are float64 in the row's unit."""


def write_parquet(data: Dataset) -> bytes:
    """Parquet file of ``data``; null only where there is no value."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    columns = dict(zip(COLUMNS, zip(*rows(data), strict=True), strict=True))
    kinds = {name: pa.string() if name in TEXTS else pa.float64() for name in columns}
    table = pa.table(
        [pa.array(column, type=kinds[name]) for name, column in columns.items()],
        schema=pa.schema(list(kinds.items()), metadata=data.facts()),
    )
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, compression="none")
    return bytes(sink.getvalue().to_pybytes())

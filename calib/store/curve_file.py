"""One curve as the bytes of a Parquet file: float64 columns, each with its unit.

Without compression and dictionary, in one row group: so any reader can read it, and the same
columns give the same bytes under one version of the Parquet library.
"""

import io

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]

UNIT = "1"
"""Unit of every column: eta, slip, normalised forces, counts and flags have no dimension."""


def curve_bytes(columns: dict[str, Array]) -> bytes:
    """Parquet file of the named ``columns``, each (n,) and dimensionless, in the given order."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    fields = [pa.field(name, pa.float64(), metadata={"unit": UNIT}) for name in columns]
    arrays = [pa.array(np.ascontiguousarray(x, dtype=np.float64)) for x in columns.values()]
    table = pa.Table.from_arrays(arrays, schema=pa.schema(fields))
    sink = io.BytesIO()
    pq.write_table(table, sink, compression="none", use_dictionary=False)
    return sink.getvalue()


def read_curve(data: bytes) -> dict[str, Array]:
    """Columns of a Parquet file, each float64 (n,). Raises ValueError for any other file."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        # Without threads: a pool that still runs when a short program ends aborts it (code 134).
        table = pq.ParquetFile(pa.BufferReader(data)).read(use_threads=False)
    except (pa.ArrowException, OSError) as error:
        raise ValueError(str(error)) from error
    return {
        name: np.asarray(table.column(name).to_numpy(), dtype=np.float64)
        for name in table.column_names
    }

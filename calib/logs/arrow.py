"""Columns of Arrow as numbers."""

from typing import Any

import numpy as np

from calib.base.arrays import Array


def numbers(column: Any) -> Array:
    """Return a chunked column of numbers (n,); null is NaN.

    From its buffers: `to_numpy` of pyarrow imports pandas, which takes longer than to read a log.
    """
    import pyarrow as pa

    chunks = (chunk for chunk in column.cast(pa.float64()).chunks if len(chunk))
    return np.concatenate([np.empty(0), *map(_chunk_numbers, chunks)])


def _chunk_numbers(chunk: Any) -> Array:
    valid, values = chunk.buffers()
    inside = slice(chunk.offset, chunk.offset + len(chunk))
    whole = np.frombuffer(values, np.float64)[inside]
    if not chunk.null_count:
        return whole
    bits = np.unpackbits(np.frombuffer(valid, np.uint8), bitorder="little")
    return np.where(bits[inside], whole, np.nan)

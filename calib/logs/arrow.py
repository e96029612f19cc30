"""Columns of Arrow as numbers."""

from typing import Any

import numpy as np

from calib.base.arrays import Array


def numbers(column: Any) -> Array:
    """Return a chunked column of numbers (n,); null is NaN.

    `to_numpy` would import pandas, and `cast` functions, which takes longer than to read a log.
    """
    import pyarrow as pa

    column = column if column.type == pa.float64() else column.cast(pa.float64())
    parts = [np.empty(0)]
    for chunk in column.chunks:
        valid, values = chunk.buffers()
        inside = slice(chunk.offset, chunk.offset + len(chunk))
        part = np.frombuffer(values or b"", np.float64)[inside]
        if chunk.null_count:
            bits = np.unpackbits(np.frombuffer(valid, np.uint8), bitorder="little")
            part = np.where(bits[inside], part, np.nan)
        parts.append(part)
    return np.concatenate(parts)

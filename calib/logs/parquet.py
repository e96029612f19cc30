"""Read and write Parquet: the metadata of each field has the unit of the channel."""

import json
from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from calib.base.arrays import Array
from calib.base.bounded import LOG
from calib.base.errors import LogError
from calib.logs.source import Column, ColumnSource, damaged
from calib.logs.text.cells import column_from_cell, from_first, over_midnight

if TYPE_CHECKING:
    import pyarrow

_UNIT_KEYS = (b"unit", b"units", b"Unit", b"Units")  # the first is written, the others are read
_MDF_CLOCK = "timestamps"  # time index [s] of a table that asammdf exported


def open_parquet(data: bytes, where: str, text_format: object = None) -> ColumnSource:
    """Open a Parquet file; ``text_format`` is not used. Raises LogError for a damaged file."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    if not data:
        raise LogError("the file is empty", where=where, expected="a Parquet file")
    try:
        file = pq.ParquetFile(pa.BufferReader(data), page_checksum_verification=True)
        schema = file.schema_arrow
        fields = list(schema)  # names that are not UTF-8 are decoded here
    except (pa.ArrowException, OSError, ValueError) as cause:
        flaw = f"not Parquet, or cut off: {cause}"
        raise damaged(where, flaw, "a complete Parquet file") from cause
    try:
        index = json.loads((schema.metadata or {}).get(b"pandas", b"{}"))["index_columns"]
        has_clock = _MDF_CLOCK in index
    except (ValueError, KeyError, TypeError):
        has_clock = False
    columns = tuple(_column(x, is_clock=has_clock and x.name == _MDF_CLOCK) for x in fields)
    if file.metadata.num_rows == 0:
        raise LogError("a header and no samples", where=where, expected="at least 50 rows")
    groups = (file.metadata.row_group(i) for i in range(file.metadata.num_row_groups))
    unpacked = sum(group.total_byte_size for group in groups)
    if max(unpacked, 8 * file.metadata.num_rows * len(columns)) > LOG.max_bytes:
        raise LogError(LOG.size_message("it unpacks to"), where=where)

    def read(indices: Sequence[int]) -> list[Array]:
        for i in indices:
            _require_numbers(fields[i].type, f"{where}: {columns[i].name}")
        names = [fields[i].name for i in indices]
        arrays = []
        try:
            if len({field.name for field in fields}) == len(fields):
                table = file.read(names, use_threads=False)
                chosen = [table.column(name) for name in names]
            else:  # a name may stand for several columns: read all of them
                table = file.read(use_threads=False)
                chosen = [table.column(i) for i in indices]
            for i, column in zip(indices, chosen, strict=True):
                if (unit := _clock_unit(column.type)) is not None:
                    arrays.append(_from_first(column, unit, f"{where}: {columns[i].name}"))
                else:
                    arrays.append(numbers(column))
        except (pa.ArrowException, OSError, ValueError) as cause:
            raise damaged(where, f"damaged: {cause}") from cause
        return arrays

    return ColumnSource(columns, read)


def _column(field: "pyarrow.Field", is_clock: bool) -> Column:
    metadata = field.metadata or {}
    if _clock_unit(field.type) is not None:
        name = "time" if is_clock else column_from_cell(field.name).name
        return Column(name, "s", field.name)
    for key in _UNIT_KEYS:
        if key in metadata:
            return Column(field.name, metadata[key].decode(errors="replace"))
    return Column("time", "s", _MDF_CLOCK) if is_clock else column_from_cell(field.name)


def _clock_unit(kind: "pyarrow.DataType") -> float | None:
    """Unit [s] in which a type of times counts; None for another type."""
    import pyarrow.types as types

    if types.is_timestamp(kind) or types.is_time(kind) or types.is_duration(kind):
        return {"s": 1.0, "ms": 1e-3, "us": 1e-6, "ns": 1e-9}[kind.unit]
    return None


def _from_first(column: "pyarrow.ChunkedArray", unit: float, where: str) -> Array:
    """Return times (n,), counted in ``unit`` [s], as seconds since the first row."""
    import pyarrow as pa
    import pyarrow.compute as pc

    # the counts of the first row are subtracted as integers: a double cannot hold ns since 1970
    width = pa.int32() if column.type.bit_width == 32 else pa.int64()
    counts = column.cast(width).cast(pa.int64())
    present = counts.drop_null()
    time = numbers(pc.subtract(counts, present[0]) if len(present) else counts) * unit
    return from_first(over_midnight(time) if pa.types.is_time(column.type) else time, where)


def _require_numbers(kind: "pyarrow.DataType", where: str) -> None:
    """Raise LogError for a column that is not numeric, before its values are read."""
    import pyarrow.types as types

    value = kind.value_type if types.is_dictionary(kind) else kind
    is_number = types.is_integer(value) or types.is_floating(value) or types.is_decimal(value)
    is_usable = is_number or types.is_boolean(value) or types.is_null(value)
    if not is_usable and _clock_unit(value) is None:
        raise LogError(f"holds {kind}, not numbers", where=where, expected="a numeric column")


def parquet_table(data: bytes) -> "pyarrow.Table":
    """Return the table of a whole Parquet file. Raises ValueError for any other file."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        # use_threads: threads that still run when the program ends would abort it (exit code 134)
        return pq.ParquetFile(pa.BufferReader(data)).read(use_threads=False)
    except (pa.ArrowException, OSError) as error:
        raise ValueError(str(error)) from error


def numbers(column: Any) -> Array:
    """Return a chunked column as numbers (n,); null becomes NaN.

    Doubles are read from their buffers, since `to_numpy` imports pandas and `cast` loads all
    functions of pyarrow; each takes longer than reading a log.
    """
    import pyarrow as pa

    column = column if column.type == pa.float64() else column.cast(pa.float64())
    parts = [np.empty(0)]
    for chunk in column.chunks:
        is_valid, values = chunk.buffers()  # one bit, and one double for each value
        inside = slice(chunk.offset, chunk.offset + len(chunk))
        part = np.frombuffer(values or b"", np.float64)[inside]
        if chunk.null_count:
            bits = np.unpackbits(np.frombuffer(is_valid, np.uint8), bitorder="little")
            part = np.where(bits[inside], part, np.nan)
        parts.append(part)
    return np.concatenate(parts)


def column_of(x: NDArray[Any]) -> "pyarrow.Array":
    """Return an array (n,) as a column of Arrow; `pyarrow.array` would import pandas."""
    import pyarrow as pa

    kind = pa.bool_() if x.dtype == bool else pa.from_numpy_dtype(x.dtype)
    data = np.packbits(x, bitorder="little") if x.dtype.kind == "b" else np.ascontiguousarray(x)
    return pa.Array.from_buffers(kind, x.size, [None, pa.py_buffer(data)])


def parquet_of(
    columns: Mapping[str, NDArray[Any]], units: Mapping[str, str], **options: Any
) -> bytes:
    """Make a Parquet file of ``columns`` (n,) with their ``units``; its bytes are reproducible."""
    return table_bytes({name: column_of(x) for name, x in columns.items()}, units, **options)


def table_bytes(
    arrays: "Mapping[str, pyarrow.Array]", units: Mapping[str, str | None], **options: Any
) -> bytes:
    """Make a Parquet file of columns of Arrow; a unit of None is not written."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    metadata = {
        name: None if unit is None else {_UNIT_KEYS[0]: unit} for name, unit in units.items()
    }
    fields = [pa.field(name, x.type, metadata=metadata[name]) for name, x in arrays.items()]
    table, sink = pa.table([*arrays.values()], pa.schema(fields)), pa.BufferOutputStream()
    pq.write_table(table, sink, **options)
    return bytes(sink.getvalue().to_pybytes())

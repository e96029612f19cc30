"""JSON, CSV, Parquet and the CSV of INCA: the data set for programs that know no calibration.

CSV and Parquet have one row per number. The unit of a bare number is ``-`` in CSV: readers that
guess types would take ``1`` for an integer, and fail at the first other unit.
"""

import csv
import io
import json
from collections.abc import Iterator
from dataclasses import asdict
from typing import Any

from calib.base.intervals import Z95
from calib.exports.build import UNIT
from calib.exports.dataset import Axis, Curve, Dataset, Scalar, printable
from calib.exports.dcm import FUNCTION
from calib.store.version import Stored

SCHEMA = 1


def write_json(data: Dataset, stored: Stored) -> bytes:
    """JSON file of ``data``; numbers read back to the last bit."""
    record, _ = stored.table.content()
    document = {
        "schema": SCHEMA,
        **data.facts(),
        "version": data.version,
        "axes": [_json_axis(axis) for axis in data.axes],
        "curves": [_json_curve(curve) for curve in data.curves],
        "scalars": [asdict(scalar) for scalar in data.scalars],
        "record": record,
    }
    return (json.dumps(document, indent=1, allow_nan=False) + "\n").encode()


def _json_axis(axis: Axis) -> dict[str, Any]:
    return {**asdict(axis), "values": axis.values.tolist()}


def _json_curve(curve: Curve) -> dict[str, Any]:
    arrays = ("values", "lower", "upper", "count", "flag")
    return {**asdict(curve), **{name: getattr(curve, name).tolist() for name in arrays}}


COLUMNS = (
    "label", "axis", "x", "value", "unit", "lower", "upper", "count", "flag", "meaning",
)  # fmt: skip
"""``value`` [unit] of ``label`` at ``x`` on ``axis``; of a scalar, axis and x are None.

``lower``, ``upper`` 95 % band; ``count``, ``flag`` as in `calib.table.table`; None where there is
none.
"""

Row = tuple[str | float | None, ...]
"""Type of a cell of the `COLUMNS`."""


def rows(data: Dataset) -> Iterator[Row]:
    """Every number of ``data``, curves first."""
    for curve in data.curves:
        yield from _points(curve, data.axis(curve.axis).values.tolist())
    for s in data.scalars:
        half = None if s.sigma is None else Z95 * s.sigma
        lower, upper = (None, None) if half is None else (s.value - half, s.value + half)
        yield (s.label, None, None, s.value, s.unit, lower, upper, None, None, s.meaning)


def _points(c: Curve, x: list[float]) -> Iterator[Row]:
    columns = (x, c.values, c.lower, c.upper, c.count, c.flag)
    for at, value, *rest in zip(*(list(map(float, column)) for column in columns), strict=True):
        yield (c.label, c.axis, at, value, c.unit, *rest, c.meaning)


BARE = "-"
"""The unit of a bare number; `calib.base.units` knows it, too."""


def write_csv(data: Dataset) -> bytes:
    """CSV file of ``data``: UTF-8, ``#`` before comments; a missing value is an empty cell."""
    text = io.StringIO()
    for key, value in data.facts().items():
        text.write(f"# {key}: {printable(value)}\n")
    table = csv.writer(text, lineterminator="\n")
    table.writerow(COLUMNS)
    for row in rows(data):
        table.writerow(map(_cell, row))
    return text.getvalue().encode()


def _cell(value: str | float | None) -> str:
    if value is None:
        return ""
    if value == UNIT:
        return BARE
    return repr(value) if isinstance(value, float) else str(value)


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


HEAD = 'CALIBRATION VALUES V2.1;.;*;""'


def write_inca_csv(data: Dataset) -> bytes:
    """CSV file of ``data``, UTF-8 with CR LF."""
    function = f"{data.prefix}_{FUNCTION}"
    lines = [HEAD, ""]
    lines += [f"* {key}: {printable(value)}" for key, value in data.facts().items()]
    lines += ["", "FUNCTION_HDR;;", f';"{function}"']
    for axis in data.axes:
        if axis.shared:
            lines += ["", *_inca_axis(axis)]
    for curve in data.curves:
        lines += ["", *_inca_curve(curve, data.axis(curve.axis)), f'FUNCTION;;"{function}"']
    for scalar in data.scalars:
        lines += ["", *_inca_scalar(scalar), f'FUNCTION;;"{function}"']
    return ("\r\n".join(lines) + "\r\n").encode()


def _inca_axis(axis: Axis) -> Iterator[str]:
    yield f";{axis.label}"
    yield f"AXIS_PTS;{_inca_unit(axis.unit)};{_inca_numbers(axis.values.tolist())}"


def _inca_curve(curve: Curve, axis: Axis) -> Iterator[str]:
    yield f";{curve.label}"
    yield f"CURVE;{axis.label if axis.shared else ''};"
    yield f"X_AXIS_PTS;{_inca_unit(axis.unit)};{_inca_numbers(axis.values.tolist())}"
    yield f";{_inca_unit(curve.unit)};{_inca_numbers(curve.values.tolist())}"


def _inca_scalar(scalar: Scalar) -> Iterator[str]:
    yield f";{scalar.label}"
    yield f"VALUE;{_inca_unit(scalar.unit)};{scalar.value!r}"


def _inca_unit(unit: str) -> str:
    return f'"[{unit}]"'


def _inca_numbers(values: list[float]) -> str:
    return ";".join(repr(v) for v in values)

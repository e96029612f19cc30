"""The results of a batch, read one column at a time, so that a large fleet needs little memory.

log, digest, status, error          text; one row a log
the rest                            figures: float64, bool or text, unit in the field metadata
"""

import re
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

from calib.errors import InputError
from calib.toml import did_you_mean

Array = NDArray[np.float64]

HEAD = ("log", "digest", "status", "error")
STATUSES = ("passed", "failed", "done", "error")


@dataclass(frozen=True)
class ResultMetric:
    """A column of figures: ``kind`` number, yes/no or text."""

    name: str
    unit: str
    kind: str


@dataclass(frozen=True)
class FleetFile:
    """An open results file: its ``logs`` and what figures it holds; values are read when asked.

    ``order`` the rows in the order of the line, (n,), as ``ordered_by`` says.
    """

    path: Path
    logs: tuple[str, ...]
    figures: tuple[ResultMetric, ...]
    order: NDArray[np.int64]
    ordered_by: str

    def numbers(self, name: str) -> Array:
        """A column of numbers in the order of the line, (n,); NaN where a log has none."""
        column = _column(self.path, name).cast("float64")
        return np.asarray(column.to_numpy(zero_copy_only=False), dtype=np.float64)[self.order]

    def texts(self, name: str) -> tuple[str | None, ...]:
        """A column of text in the order of the line."""
        values = _column(self.path, name).to_pylist()
        return tuple(values[i] for i in self.order)


def open_fleet(path: Path, order: str | None = None) -> FleetFile:
    """Open the results of a batch; ``order`` a column that orders the line, else the logs' names.

    Raises InputError for what is no such file, an unknown status, or an unknown column.
    """
    schema = _schema(path)
    missing = [name for name in ("log", "status", "error") if name not in schema.names]
    if missing:
        raise InputError(
            f"no column {missing[0]!r}", where=path, expected="results.parquet of `brake-cal batch`"
        )
    logs = [str(name) for name in _column(path, "log").to_pylist()]
    if not logs:
        raise InputError("no row in it", where=path, expected="one row a log")
    odd = sorted({str(s) for s in _column(path, "status").to_pylist()} - {*STATUSES})
    if odd:
        raise InputError(f"status {odd[0]!r}", where=path, expected=", ".join(STATUSES))
    rows, told = _ordered(path, order, logs, schema.names)
    figures = tuple(_figure(f) for f in schema if f.name not in HEAD)
    return FleetFile(path, tuple(logs[i] for i in rows), figures, np.asarray(rows), told)


def _schema(path: Path) -> Any:
    import pyarrow as pa
    import pyarrow.parquet as pq

    if not path.is_file():
        what = "a directory" if path.is_dir() else "no such file"
        raise InputError(what, where=path, expected="results.parquet of `brake-cal batch`")
    try:
        with path.open("rb") as file:  # pyarrow opens no path that is not UTF-8
            return pq.read_schema(file)
    except (pa.ArrowInvalid, OSError) as cause:
        raise InputError("not a Parquet file, or cut off", where=path) from cause


def _column(path: Path, name: str) -> Any:
    import pyarrow as pa
    import pyarrow.parquet as pq

    try:
        # Without threads: a pool still at work when a short program ends aborts it.
        with path.open("rb") as opened, pq.ParquetFile(opened) as file:
            return file.read(columns=[name], use_threads=False).column(0).combine_chunks()
    except (pa.ArrowInvalid, OSError) as cause:
        raise InputError(f"column {name!r} cannot be read", where=path) from cause


def _figure(field: Any) -> ResultMetric:
    import pyarrow.types as kinds

    unit = (field.metadata or {}).get(b"unit", b"1").decode()
    if kinds.is_boolean(field.type):
        return ResultMetric(field.name, unit, "yes/no")
    number = kinds.is_floating(field.type) or kinds.is_integer(field.type)
    return ResultMetric(field.name, unit, "number" if number else "text")


def _ordered(
    path: Path, order: str | None, logs: list[str], columns: list[str]
) -> tuple[list[int], str]:
    """Rows in the order of the line. A row without a value in the column goes to the end."""
    if order is None or order == "log":
        return sorted(range(len(logs)), key=lambda i: natural(logs[i])), "the logs' names"
    if order not in columns:
        raise InputError(
            f"no column {order!r}",
            where=path,
            expected=f"one of {', '.join(columns)}",
            do=did_you_mean(order, columns),
        )
    values = _column(path, order).to_pylist()
    lost = sum(_unknown(v) for v in values)
    rows = sorted(range(len(logs)), key=lambda i: (_unknown(values[i]), _key(values[i])))
    return rows, order + (f" ({lost} rows without it at the end)" if lost else "")


def _unknown(value: object) -> bool:
    return value is None or value != value


def _key(value: object) -> Any:
    if _unknown(value):
        return 0
    return natural(value) if isinstance(value, str) else value


def natural(text: str) -> list[tuple[int, int, str]]:
    """Sort key that puts ``log10`` after ``log9``."""
    parts = re.split(r"(\d+)", text)
    return [(1, int(p), "") if p.isdecimal() else (0, 0, p) for p in parts]

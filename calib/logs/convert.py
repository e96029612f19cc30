"""Write every column of a log as CSV, Parquet or MDF; values as they are, to the last bit.

CSV        name [unit]; the shortest number that is read back as the same one; empty for no value
Parquet    the unit in the metadata of the field; null for no value
MDF 4      one group with the time of the log in seconds; NaN for no value
"""

import csv
import io
import tempfile
from collections.abc import Callable
from pathlib import Path

from calib.logs.extra import need
from calib.logs.text.header import column_from_cell
from calib.logs.whole import TIME, WholeColumn, WholeLog
from calib.logs.write import parquet_bytes
from calib.printable import one_line


def to_csv(log: WholeLog) -> bytes:
    """The log as comma-separated text."""
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    rows.writerow([_cell(column) for column in log.columns])
    rows.writerows(zip(*(_texts(column) for column in log.columns), strict=True))
    return text.getvalue().encode()


def _texts(column: WholeColumn) -> list[str]:
    return ["" if x != x else repr(x) for x in column.values.tolist()]


def _cell(column: WholeColumn) -> str:
    """A header cell that is read back as this name and unit."""
    name = one_line(column.name)
    if column.unit:
        return f"{name} [{column.unit}]"
    return f"{name} []" if _has_unit(name) else name


def _has_unit(name: str) -> bool:
    """Whether a name alone would be read as a name and a unit."""
    read = column_from_cell(name)
    return (read.name, read.unit) != (name, None)


def to_parquet(log: WholeLog) -> bytes:
    """The log as Parquet."""
    return parquet_bytes((column.name, _unit(column), column.values) for column in log.columns)


def _unit(column: WholeColumn) -> str | None:
    """The unit to write; an empty one keeps the name whole."""
    return column.unit or ("" if _has_unit(column.name) else None)


def to_mdf(log: WholeLog) -> bytes:
    """The log as MDF 4.10. Raises LogError without a clock, or if asammdf is not installed."""
    asammdf = need("asammdf", "mdf", log.source)
    signals = [
        asammdf.Signal(column.values, log.time, unit=column.unit or "", name=column.name)
        for column in log.columns
        if column.name != TIME
    ]
    with tempfile.TemporaryDirectory() as folder, asammdf.MDF(version="4.10") as mdf:
        mdf.append(signals, acq_name=log.name, comment=log.name, common_timebase=True)
        path = mdf.save(Path(folder) / "log.mf4", overwrite=True)
        return Path(path).read_bytes()


WRITERS: dict[str, Callable[[WholeLog], bytes]] = {
    ".csv": to_csv,
    ".parquet": to_parquet,
    ".mf4": to_mdf,
}
"""What makes the bytes of a file, by its ending."""

ENDINGS = tuple(WRITERS)


def log_content(log: WholeLog, ending: str) -> bytes:
    """The bytes of a file of an ``ending``, one of `ENDINGS`. Raises LogError as `to_mdf`."""
    return WRITERS[ending](log)

"""Write a log: its channels in canonical units, or every column with all digits.

CSV        ``name [unit]`` in the header; an empty cell for no value
Parquet    the unit in the metadata of the field; null for no value
MDF 4      one group with the time of the log in seconds; NaN for no value
"""

import csv
import io
import math
import tempfile
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np

from calib.base.errors import LogError, one_line
from calib.base.extras import need
from calib.base.names import CHANNELS, TRUTH_UNITS
from calib.base.units import from_si
from calib.base.write import write_whole
from calib.logs.log import Log
from calib.logs.parquet import table_bytes
from calib.logs.text.cells import column_from_cell
from calib.logs.whole import TIME, WholeColumn, WholeLog

_DECIMALS = 6  # decimals of a CSV file in canonical units: less than the resolution of any sensor


def write_csv(log: Log, path: Path) -> None:
    """Write ``log`` as CSV in canonical units with six decimals, truth channels last.

    Raises ValueError for a value that is not finite, OSError if ``path`` cannot be written.
    """
    whole = _in_canonical_units(log)
    # adding 0.0 turns a rounded -0.0 into 0.0
    rounded = (replace(c, values=np.round(c.values, _DECIMALS) + 0.0) for c in whole.columns)
    write_whole(Path(path), _to_csv(replace(whole, columns=tuple(rounded))))


def write_parquet(log: Log, path: Path) -> None:
    """Write ``log`` as Parquet in canonical units. Raises as `write_csv`."""
    write_whole(Path(path), _to_parquet(_in_canonical_units(log)))


def _in_canonical_units(log: Log) -> WholeLog:
    """Convert all channels, truth last. Raises ValueError for a value that is not finite."""
    columns = []
    channels = {name: log[name] for name in CHANNELS if name in log}
    for name, values in (channels | log.truth).items():
        if not np.isfinite(values).all():
            raise ValueError(f"{name} holds values that are not finite")
        if quantity := CHANNELS.get(name):
            values, unit = from_si(values, quantity.unit, quantity.si), quantity.unit
        else:  # a truth channel is written in SI
            unit = TRUTH_UNITS[name.rpartition("_")[0]]
        columns.append(WholeColumn(name, unit, values))
    return WholeLog(log.name, log.source, log.digest, tuple(columns))


def _to_csv(log: WholeLog) -> bytes:
    text = io.StringIO()
    rows = csv.writer(text, lineterminator="\n")
    header = []
    for column in log.columns:
        name = one_line(column.name)
        unit = _unit(name, column.unit)
        header.append(name if unit is None else f"{name} [{unit}]")
    rows.writerow(header)
    cells = (["" if math.isnan(x) else repr(x) for x in c.values.tolist()] for c in log.columns)
    rows.writerows(zip(*cells, strict=True))
    return text.getvalue().encode()


def _unit(name: str, unit: str | None) -> str | None:
    """Return the unit to write; "" keeps a name such as ``x_bar`` from being read with a unit."""
    if unit:
        return unit
    as_read = column_from_cell(name)
    return None if as_read.name == name and as_read.unit is None else ""


def _to_parquet(log: WholeLog) -> bytes:
    import pyarrow as pa

    arrays = {c.name: pa.array(c.values, pa.float64(), from_pandas=True) for c in log.columns}
    units = {c.name: _unit(c.name, c.unit) for c in log.columns}
    options = {"compression": "zstd", "use_dictionary": False, "write_page_checksum": True}
    return table_bytes(arrays, units, **options)


def _to_mdf(log: WholeLog) -> bytes:
    """Make an MDF 4 file. Raises LogError without a time in the log, or without asammdf."""
    asammdf = need("asammdf", "mdf", log.source, LogError)
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
    ".csv": _to_csv,
    ".parquet": _to_parquet,
    ".mf4": _to_mdf,
}
"""By file ending: the function that makes the bytes of a file."""

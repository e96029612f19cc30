"""Results of a batch with a known fleet: an outlier, errors, a quiet metric; journals."""

import sqlite3
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.parquet as pq

from calib.line.fleet.journal import NAME

OUTLIER, LOST = 133, (13, 57, 185)


def results(path, n=400, extra=None):
    """Write results of ``n`` logs."""
    rng = np.random.default_rng(1)
    pads = 0.38 + 0.01 * rng.normal(size=n)
    if n > OUTLIER:
        pads[OUTLIER] = 0.55
    lost = np.isin(np.arange(n), LOST) & (n > 20)
    logs = [f"line/car{i + 1}.csv" for i in range(n)]
    columns = {
        "log": (logs, pa.string(), None),
        "digest": ([f"{i:064x}" for i in range(n)], pa.string(), None),
        "status": (["error" if x else "passed" for x in lost], pa.string(), None),
        "error": (
            [f"{log}: <b>ends</b> at {i}.5 s" if x else None
             for i, (log, x) in enumerate(zip(logs, lost, strict=True))], pa.string(), None),
        "pad_friction_f": (np.where(lost, np.nan, pads), pa.float64(), "1"),
        "settling": (0.3 + 0.02 * rng.normal(size=n), pa.float64(), "s"),
        "built": ([float(n - i) for i in range(n)], pa.float64(), "s"),
        "usable": ([bool(i % 4) for i in range(n)], pa.bool_(), "1"),
        "verdict": (["no_gap" if i % 3 else "named" for i in range(n)], pa.string(), "1"),
    } | (extra or {})  # fmt: skip
    fields = [
        pa.field(k, t, metadata={"unit": u} if u else None) for k, (_, t, u) in columns.items()
    ]
    arrays = [pa.array(v, type=t, from_pandas=True) for v, t, _ in columns.values()]
    with path.open("wb") as file:  # by its bytes: the name of a folder need not be UTF-8
        pq.write_table(pa.Table.from_arrays(arrays, schema=pa.schema(fields)), file)
    return path


def journalled(out: Path) -> dict[str, str | None]:
    """Logs in the journal of ``out`` that no run has open, each with its error."""
    db = sqlite3.connect(out / NAME)
    errors = dict(db.execute("SELECT log, error FROM rows"))
    db.close()
    return errors

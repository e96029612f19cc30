"""Files of `validate --out`: one row per sample as Parquet, and the summary as JSON.

Units are in the metadata of each column, so that any Parquet reader can show them. Files are
written completely or not at all.
"""

import contextlib
import json
import os
import tempfile
from pathlib import Path

from calib.estimation.estimator import COLUMNS, Estimate
from calib.files import write_whole
from calib.validation.validate import Validation

SUMMARY = "summary.json"


def write_result(e: Estimate, path: Path) -> None:
    """Write the columns of one estimate as Parquet. Raises OSError if it cannot."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    data = e.columns()
    fields = [
        pa.field(name, pa.bool_() if name == "valid" else pa.float64(), metadata={"unit": unit})
        for name, unit in COLUMNS.items()
    ]
    table = pa.table([pa.array(data[name]) for name in COLUMNS], schema=pa.schema(fields))
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, compression="zstd")
    write_whole(path, sink.getvalue().to_pybytes())


def write_results(results: list[Validation], summary: dict[str, object], out: Path) -> list[Path]:
    """Write ``out``/<log>.parquet for every log and ``out``/summary.json; return the paths.

    All are made in a hidden directory first and then moved into place, so that a full disk leaves
    none of them. Raises OSError if ``out`` cannot be written.
    """
    made = not out.exists()
    out.mkdir(parents=True, exist_ok=True)
    try:
        with tempfile.TemporaryDirectory(prefix=".new-", dir=out) as work:
            names = [f"{result.log}.parquet" for result in results]
            for name, result in zip(names, results, strict=True):
                write_result(result.estimate, Path(work) / name)
            text = json.dumps(summary, indent=2, allow_nan=False) + "\n"
            write_whole(Path(work) / SUMMARY, text.encode())
            for name in (*names, SUMMARY):
                os.replace(Path(work) / name, out / name)
    except BaseException:
        if made:
            with contextlib.suppress(OSError):
                out.rmdir()
        raise
    return [out / name for name in (*names, SUMMARY)]

"""Files of `validate --out`: one row per sample as Parquet, and the summary as JSON.

Units are in the metadata of each column, so that any Parquet reader can show them. Files are
written completely or not at all.
"""

import json
from pathlib import Path

from calib.base.publish import publish, workshop
from calib.base.write import write_whole
from calib.estimation.estimator import COLUMNS, Estimate
from calib.estimation.validate import Validation

SUMMARY = "summary.json"


def write_result(e: Estimate, path: Path) -> None:
    """Write the columns of one estimate as Parquet. Raises OSError if it cannot."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    data = e.columns()
    fields = [
        pa.field(name, pa.from_numpy_dtype(data[name].dtype), metadata={"unit": unit})
        for name, unit in COLUMNS.items()
    ]
    table = pa.table([pa.array(data[name]) for name in COLUMNS], schema=pa.schema(fields))
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, compression="zstd")
    write_whole(path, sink.getvalue().to_pybytes())


def write_results(results: list[Validation], summary: dict[str, object], out: Path) -> list[Path]:
    """Write ``out``/<log>.parquet for every log and ``out``/summary.json; return the paths.

    All of them or none, the summary last. Results of other logs in ``out`` stay. Raises OSError if
    ``out`` cannot be written.
    """
    with workshop(out) as work:
        fill(results, summary, work)
        return publish(work, out, SUMMARY)


def fill(results: list[Validation], summary: dict[str, object], work: Path) -> None:
    """Write the files of `write_results` into the folder ``work``. Raises OSError."""
    for result in results:
        write_result(result.estimate, work / f"{result.log}.parquet")
    text = json.dumps(summary, indent=2, allow_nan=False) + "\n"
    write_whole(work / SUMMARY, text.encode())

"""What `validate --out` leaves behind: one row per sample as Parquet, and the summary as JSON.

Units stand in the metadata of each column, so that any Parquet reader can show them. Files are
written whole or not at all.
"""

import contextlib
import json
import os
import tempfile
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from calib.estimation.estimator import Estimate
from calib.files import write_whole
from calib.validation.validate import Validation

UNITS = {
    "time": "s",
    "z": "1",
    "eta": "1",
    "normalised_force_f": "1",
    "normalised_force_r": "1",
    "pad_friction_f": "1",
    "pad_friction_r": "1",
    "pad_friction_f_lower": "1",
    "pad_friction_f_upper": "1",
    "pad_friction_r_lower": "1",
    "pad_friction_r_upper": "1",
    "brake_torque_fl": "N*m",
    "brake_torque_fr": "N*m",
    "brake_torque_rl": "N*m",
    "brake_torque_rr": "N*m",
    "valid": "1",
}
"""Columns of a result, in their order."""

SUMMARY = "summary.json"


def columns(e: Estimate) -> dict[str, NDArray[np.float64] | NDArray[np.bool_]]:
    """Columns of one result, (n,) each. Both wheels of an axle carry its pad friction."""
    f, r = e.front, e.rear
    values = (
        e.time,
        e.z,
        e.eta,
        f.normalised_force,
        r.normalised_force,
        f.pad_friction,
        r.pad_friction,
        f.lower,
        f.upper,
        r.lower,
        r.upper,
        f.torque,
        f.torque,
        r.torque,
        r.torque,
        e.valid,
    )
    return dict(zip(UNITS, values, strict=True))


def write_result(e: Estimate, path: Path) -> None:
    """Write the columns of one estimate as Parquet. Raises OSError if it cannot."""
    import pyarrow as pa
    import pyarrow.parquet as pq

    data = columns(e)
    fields = [
        pa.field(name, pa.bool_() if name == "valid" else pa.float64(), metadata={"unit": unit})
        for name, unit in UNITS.items()
    ]
    table = pa.table([pa.array(data[name]) for name in UNITS], schema=pa.schema(fields))
    sink = pa.BufferOutputStream()
    pq.write_table(table, sink, compression="zstd")
    write_whole(path, sink.getvalue().to_pybytes())


def write_results(results: list[Validation], summary: dict[str, object], out: Path) -> list[Path]:
    """Write ``out``/<log>.parquet for every log and ``out``/summary.json; return the paths.

    All are made in a hidden directory first and then moved into place, so that a full disk leaves
    nothing of them. Raises OSError if ``out`` cannot be written.
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

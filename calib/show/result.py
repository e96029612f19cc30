"""A stored result: the Parquet file that `brake-cal validate --out` writes for each log."""

import hashlib
import io
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from calib.base.arrays import Array, Mask
from calib.base.bounded import RESULT, read_bounded
from calib.base.errors import InputError

COLUMNS = (
    *("time", "z", "eta", "normalised_force_f", "normalised_force_r"),
    *(f"ecu_pad_friction_{axle}{end}" for axle in "fr" for end in ("", "_lower", "_upper")),
    *(f"ecu_brake_torque_{wheel}" for wheel in ("fl", "rl")),  # both of an axle have the same
)
"""Numeric columns of a result that are drawn."""
_VALID = ("valid", "ecu_valid")


@dataclass(frozen=True)
class StoredResult:
    """Answers of the ECU to one log, shapes (n,): ``values`` by `COLUMNS`, ``valid``.

    Of a run of which no sample counts, none is valid. ``name`` is the stem of the log; ``digest``
    the SHA-256 of the file.
    """

    name: str
    digest: str
    values: dict[str, Array]
    valid: Mask


def is_result(path: Path) -> bool:
    """Whether ``path`` is a Parquet file with the columns that only a result has."""
    from pyarrow import ArrowException
    from pyarrow.parquet import read_schema

    if path.suffix.lower() != ".parquet" or not path.is_file():
        return False
    try:
        names = set(read_schema(path).names)
    except (OSError, ArrowException, ValueError):
        return False  # it is then read as a log, which reports the cause
    return {"valid", "pad_friction_f", "pad_friction_r"} <= names


def read_result(path: Path) -> StoredResult:
    """Read a result. Raises InputError when it is unreadable, empty or lacks a column."""
    from pyarrow import ArrowException
    from pyarrow.parquet import read_table

    try:
        data = read_bounded(path, RESULT)
        found = read_table(io.BytesIO(data))
        missing = [name for name in (*COLUMNS, *_VALID) if name not in found.column_names]
        if missing or found.num_rows < 2:
            raise InputError(
                f"no column {', '.join(missing)}" if missing else "fewer than two samples",
                where=path,
                expected="a result of `brake-cal validate --out`",
            )
        values = {name: np.asarray(found[name].to_numpy(), dtype=float) for name in COLUMNS}
        best, ecu = (np.asarray(found[x].to_numpy(zero_copy_only=False), bool) for x in _VALID)
    except (OSError, ArrowException, TypeError, ValueError) as cause:
        raise InputError(f"cannot be read ({cause})", where=path) from cause
    return StoredResult(path.stem, hashlib.sha256(data).hexdigest(), values, ecu & best.any())

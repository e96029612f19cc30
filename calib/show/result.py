"""A stored result: the Parquet file that `brake-cal validate --out` writes for each log."""

import json
from dataclasses import dataclass
from pathlib import Path

from calib.base.arrays import Array, Mask
from calib.base.bounded import RESULT, read_bounded
from calib.base.digest import sha256
from calib.base.errors import InputError
from calib.estimation.limits import FAILED, PASSED
from calib.estimation.results import SUMMARY
from calib.estimation.validate import NONE
from calib.logs.parquet import numbers, parquet_table
from calib.show.judged import verdict_words
from calib.show.torque import ENDS
from calib.store.evidence import CONSISTENT

COLUMNS = (
    *("time", "z", "eta", "normalised_force_f", "normalised_force_r", "ecu_reason"),
    *("pad_friction_f", "pad_friction_r"),
    *(f"ecu_pad_friction_{axle}{end}" for axle in "fr" for end in ENDS),
    *(f"ecu_brake_torque_{part}{end}" for part in ("fl", "rl", "sum") for end in ENDS),
)
"""Numeric columns of a result that are drawn."""
_VALID = ("valid", "ecu_valid")
"""Columns that say where the best estimate and the ECU are valid."""


@dataclass(frozen=True)
class StoredResult:
    """What an ECU answers to one log.

    Attributes
    ----------
    name : stem of the log's name.
    digest : SHA-256 of the file.
    values : the `COLUMNS` (n,) by their names.
    valid : samples (n,) in which the answer of the ECU counts.
    verdict : the verdict in words; "" without a summary beside the file.
    ramp_pads : pad friction of the front and the rear axle on the ramp [1]; () without a summary.
    """

    name: str
    digest: str
    values: dict[str, Array]
    valid: Mask
    verdict: str = ""
    ramp_pads: tuple[float, ...] = ()


def is_result(path: Path) -> bool:
    """Return whether ``path`` is a Parquet file with the columns that only a result has."""
    from pyarrow import ArrowException
    from pyarrow.parquet import read_schema

    if path.suffix.lower() != ".parquet" or not path.is_file():
        return False
    try:
        names = set(read_schema(path).names)
    except (OSError, ArrowException, ValueError):
        return False  # the caller reads it as a log, and reports the cause
    return {"valid", "pad_friction_f", "pad_friction_r"} <= names


def read_result(path: Path) -> StoredResult:
    """Read a result. Raises InputError when it is unreadable, empty or lacks a column."""
    from pyarrow import ArrowException

    try:
        data = read_bounded(path, RESULT)
        columns = parquet_table(data)
        missing = [name for name in (*COLUMNS, *_VALID) if name not in columns.column_names]
        if missing or columns.num_rows < 2:
            raise InputError(
                f"no column {', '.join(missing)}" if missing else "fewer than two samples",
                where=path,
                expected="a result of `brake-cal validate --out`",
            )
        values = {name: numbers(columns[name]) for name in COLUMNS}
        best_valid, ecu_valid = (numbers(columns[name]) > 0.0 for name in _VALID)
    except (OSError, ArrowException, TypeError, ValueError) as cause:
        raise InputError(f"cannot be read ({cause})", where=path) from cause
    digest = sha256(data)
    # in a run where the best estimate is nowhere valid, no answer of the ECU counts
    valid = ecu_valid & best_valid.any()
    return StoredResult(path.stem, digest, values, valid, *_summary_of(path))


def _summary_of(path: Path) -> tuple[str, tuple[float, ...]]:
    """Return the verdict in words and the pads of the ramp, from the summary beside a result."""
    try:
        summary = json.loads(path.with_name(SUMMARY).read_bytes())
        (log,) = (one for one in summary["logs"] if one["log"] == path.stem)
        passed = PASSED if log["proof"] != NONE else CONSISTENT
        verdict = FAILED if log["verdict"] == FAILED else passed
        warnings = sum(one["log"] == path.stem for one in summary["warnings"])
        return verdict_words(log["role"], verdict, warnings), tuple(summary["ramp_pads"])
    except (OSError, ValueError, KeyError, TypeError):
        return "", ()

"""A stored result: the Parquet file that `brake-cal validate --out` writes for each log."""

import io
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
from calib.logs.parquet import numbers
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


@dataclass(frozen=True)
class StoredResult:
    """Answers of the ECU to one log, shapes (n,): ``values`` by `COLUMNS`, ``valid``.

    ``name`` is the stem of the log, ``digest`` the SHA-256 of the file. ``verdict``, in
    words, and ``ramp_pads``, the pad friction on the ramp [1], come from the summary beside it;
    both are empty without one.
    """

    name: str
    digest: str
    values: dict[str, Array]
    valid: Mask
    verdict: str = ""
    ramp_pads: tuple[float, ...] = ()


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
        columns = read_table(io.BytesIO(data))
        missing = [name for name in (*COLUMNS, *_VALID) if name not in columns.column_names]
        if missing or columns.num_rows < 2:
            raise InputError(
                f"no column {', '.join(missing)}" if missing else "fewer than two samples",
                where=path,
                expected="a result of `brake-cal validate --out`",
            )
        values = {name: numbers(columns[name]) for name in COLUMNS}
        by_v, by_ecu = (numbers(columns[name]) > 0.0 for name in _VALID)
    except (OSError, ArrowException, TypeError, ValueError) as cause:
        raise InputError(f"cannot be read ({cause})", where=path) from cause
    digest = sha256(data)
    # Where not even the estimate with v holds, no answer of the ECU does.
    return StoredResult(path.stem, digest, values, by_ecu & by_v.any(), *_summary_of(path))


def _summary_of(path: Path) -> tuple[str, tuple[float, ...]]:
    """Verdict in words and pads of the ramp, from the summary beside a result."""
    try:
        summary = json.loads(path.with_name(SUMMARY).read_bytes())
        (log,) = (one for one in summary["logs"] if one["log"] == path.stem)
        passed = PASSED if log["proof"] != NONE else CONSISTENT
        verdict = FAILED if log["verdict"] == FAILED else passed
        warnings = sum(one["log"] == path.stem for one in summary["warnings"])
        return verdict_words(log["role"], verdict, warnings), tuple(summary["ramp_pads"])
    except (OSError, ValueError, KeyError, TypeError):
        return "", ()

"""A stored result: the Parquet file that `brake-cal validate --out` writes for each log.

Verdict, torque errors and warnings come from `summary.json` beside the file, if it is there.
"""

import json
from dataclasses import dataclass, replace
from pathlib import Path

from calib.base.arrays import Array, Mask
from calib.base.bounded import RESULT, read_bounded
from calib.base.digest import sha256
from calib.base.errors import InputError
from calib.base.warning import PlausibilityWarning
from calib.estimation.limits import FAILED, PASSED, Judgement
from calib.estimation.readout import ENDS
from calib.estimation.results import SUMMARY
from calib.estimation.validate import NONE, REFERENCE
from calib.logs.parquet import numbers, parquet_table
from calib.show.judged import broken_limits, verdict_words, warning_note
from calib.show.torque import errors_in
from calib.store.evidence import CONSISTENT

COLUMNS = (
    "time", "z", "eta", "normalised_force_f", "normalised_force_r", "ecu_reason",
    "pad_friction_f", "pad_friction_r",
    *(f"ecu_pad_friction_{axle}{end}" for axle in "fr" for end in ENDS),
    *(
        f"{prefix}brake_torque_{part}{end}"
        for prefix in ("", "ecu_") for part in ("fl", "rl", "sum") for end in ENDS
    ),
)  # fmt: skip
"""Numeric columns of a result that are drawn or compared."""
_VALID = ("valid", "ecu_valid")
"""Columns that say where the best estimate and the ECU are valid."""


@dataclass(frozen=True)
class StoredResult:
    """The estimates of an ECU for one log; the last two fields are () without a summary."""

    name: str  # stem of the log's name
    values: dict[str, Array]  # the `COLUMNS` (n,)
    valid: Mask  # samples (n,) in which the estimate of the ECU counts
    note: str  # digest of the file, and table and warnings of the summary
    verdict: tuple[str, ...] = ()  # the verdict, broken limits and torque errors in words
    ramp_pads: tuple[float, ...] = ()  # front and rear pad friction on the ramp [1]


def is_result(path: Path) -> bool:
    """Return whether ``path`` is a Parquet file with columns that only a result has."""
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
    """Read a result. Raises InputError if it is unreadable, too short or lacks a column."""
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
    # in a run where the best estimate is nowhere valid, no estimate of the ECU counts
    valid = ecu_valid & best_valid.any()
    note = f"Result {path.stem}, digest {sha256(data)[:16]}."
    result = StoredResult(path.stem, values, valid, note)
    try:
        return _with_summary(result, path, best_valid)
    except (OSError, ValueError, KeyError, TypeError, AttributeError, InputError):
        return result  # there is no summary, or it is damaged or of other results


def _with_summary(result: StoredResult, path: Path, best_valid: Mask) -> StoredResult:
    """Return a result with its verdict, table and warnings from the summary beside its file."""
    summary = json.loads(path.with_name(SUMMARY).read_bytes())
    (log,) = (entry for entry in summary["logs"] if entry["log"] == result.name)
    warnings = [PlausibilityWarning(**entry) for entry in summary["warnings"]]
    titles = [warning.title for warning in warnings if warning.log == result.name]
    passed = PASSED if log["proof"] != NONE else CONSISTENT
    verdict = FAILED if log["verdict"] == FAILED else passed
    # `required` matters only without a value, and a metric that failed without one was required
    judgements = [
        Judgement(x["figure"], x["min"], x["max"], required=x["passed"] is False, value=x["value"])
        for x in log["limits"]
    ]
    has_v = log["rms_error_against"] == REFERENCE
    compared = result.valid & best_valid & has_v  # no sample without v
    error = errors_in(log["figures"], result.values, compared)
    words = verdict_words(log["role"], verdict, len(titles))
    table = f" Table {summary['table']}, digest {summary['digest'][:16]}."
    return replace(
        result,
        note=result.note + table + warning_note(titles),
        verdict=(words, *broken_limits(judgements), *error.in_words),
        ramp_pads=tuple(summary["ramp_pads"]),
    )

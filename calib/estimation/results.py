"""Write the results of a validation: one row per sample as Parquet, and the summary as JSON.

The metadata of each column holds its unit. Files are written completely or not at all.
"""

import json
from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path

from calib.base.plain import finite_or_none
from calib.base.warning import to_dict as warning_dict
from calib.base.write import publish, work_folder, write_whole
from calib.estimation.agreement import agreement
from calib.estimation.estimator import COLUMNS
from calib.estimation.limits import FAILED, PASSED
from calib.estimation.validate import CALIBRATION, NO_HOLDOUT, Validation, proof_of
from calib.logs.parquet import parquet_of
from calib.store.version import Stored
from calib.table.budget import by_axle
from calib.table.exported import Precision
from calib.table.unseen import Unseen, unseen_entries

SUMMARY = "summary.json"


def to_dict(
    stored: Stored, results: list[Validation], precision: Precision | None = None
) -> dict[str, object]:
    """Return `summary.json`; ``precision`` is that of the exported table, None for full maps."""
    between_stops, ramp = agreement(results), stored.table.calibration
    warnings = [*stored.table.warnings, *(w for r in results for w in r.all_warnings)]
    return {
        "schema": 1,
        "table": stored.id,
        "digest": stored.digest,
        "state": stored.state.word,
        "mass": asdict(results[0].mass) if results else None,
        "warnings": [warning_dict(w) for w in warnings],
        "verdict": PASSED if all(r.passed for r in results) else FAILED,
        "proof": proof_of(results),
        "exported": None if precision is None else asdict(precision),
        "ramp_pads": [ramp.pad_friction_f.value, ramp.pad_friction_r.value],
        "logs": [_of_log(r) for r in results],
        "agreement": None if between_stops is None else asdict(between_stops),
        "unseen": [entry._asdict() for entry in unseen_in(stored, results)],
    }


def unseen_in(stored: Stored, results: Sequence[Validation]) -> list[Unseen]:
    """Return the entries of the vehicle file whose errors neither ramp nor stops can show."""
    with_v = any(r.estimate.run.blocks.v is not None for r in results)
    return unseen_entries(stored.table, with_v, results[0].mass.tolerance if results else None)


def _of_log(r: Validation) -> dict[str, object]:
    entry: dict[str, object] = {
        "log": r.log,
        "digest": r.digest,
        "role": r.role,
        "verdict": PASSED if r.passed else FAILED,
        "proof": r.proof,
        "figures": {key: finite_or_none(value) for key, value in r.figures.items()},
        "limits": [
            {"figure": j.figure, "value": finite_or_none(j.value), "min": j.low, "max": j.high}
            | {"warn": [j.warn_low, j.warn_high], **j.outcome}
            for j in r.judgements
        ],
        "not_held": [j.figure for j in r.judgements if j.verdict == FAILED],
        "warned": list(dict.fromkeys(warning.code for warning in r.all_warnings)),
        "budget": None if r.budget is None else by_axle(r.budget),
        "not_valid": r.refused,
        "rms_error_against": r.compared_with,
        "rms_error_by_method": {
            name: {"front": front, "rear": rear} for name, (front, rear) in r.baselines.items()
        },
    }
    if r.role == CALIBRATION:
        entry["notes"] = [NO_HOLDOUT]
    return entry


def write_results(results: list[Validation], summary: dict[str, object], out: Path) -> list[Path]:
    """Write <log>.parquet of every log and the summary into ``out``, all or none, or raise OSError.

    Return the paths. Results of other logs in ``out`` stay.
    """
    with work_folder(out) as work:
        fill(results, summary, work)
        return publish(work, out, SUMMARY)


def fill(results: list[Validation], summary: dict[str, object], work: Path) -> None:
    """Write the files of `write_results` into the folder ``work``. Raises OSError."""
    for result in results:
        samples = parquet_of(result.estimate.columns(), COLUMNS, compression="zstd")
        write_whole(work / f"{result.log}.parquet", samples)
    text = json.dumps(summary, indent=2, allow_nan=False) + "\n"
    write_whole(work / SUMMARY, text.encode())

"""Write the files of a run at the station, all of them or none.

DIR/station.json, junit.xml, report.html, summary.json, <stop>.parquet, exports
DIR/refused.json instead, if the car could not be judged: its identity and the reason

`station.json` is moved to its place last: a run without it is not complete. It holds no time and no
path, so the same logs, limits and identifiers give the same bytes.
"""

import json
from collections.abc import Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any

from calib.base.bounded import VALIDATION, read_bounded
from calib.base.errors import BrakeCalError, printable
from calib.base.names import PROGRAM
from calib.base.plain import NBSP, finite_or_none, metric_of
from calib.base.templates import templates
from calib.base.warning import to_dict as warning_dict
from calib.base.write import publish, work_folder, write_whole
from calib.estimation.limits import FAILED, WARNING
from calib.estimation.results import to_dict as validation_dict
from calib.exports.export import ENDINGS
from calib.line.station.station import Identity, StationCheck, StationOutcome
from calib.store.version import Stored
from calib.table.table import Table

DOCUMENT, JUNIT, REPORT, REFUSED = "station.json", "junit.xml", "report.html", "refused.json"
_FIXED = (DOCUMENT, JUNIT, REPORT, "summary.json")


def export_name(form: str) -> str:
    """Return the file name of an export in the format ``form``."""
    return f"table.{ENDINGS[form]}"


def outputs_of(stops: Sequence[str], forms: Sequence[str]) -> list[str]:
    """Return every file that a run may write; ``stops`` are hold-outs, ``forms`` the exports."""
    return [*_FIXED, REFUSED, *map(export_name, forms), *(f"{stop}.parquet" for stop in stops)]


def why_not_exported(stored: Stored) -> str:
    """Return why the station does not export this table for an ECU; "" if it does."""
    if not stored.state.released:
        return "only a released table may reach an ECU"
    beyond = ", ".join(stored.table.not_sensed)
    return f"an ECU cannot sense {beyond}; see `brake-cal tables export`" if beyond else ""


def publish_run(work: Path, out: Path) -> list[Path]:
    """Move all files of ``work`` to ``out``, the verdict last; return the paths. Raises OSError.

    Files of an earlier run are removed: a car that fails must not keep the export of its pass.
    """
    return publish(work, out, DOCUMENT, _stale)


def _stale(out: Path) -> set[str]:
    """Return every export, an earlier refusal, and the files that an earlier verdict lists."""
    stale = {*map(export_name, ENDINGS), REFUSED}
    with suppress(OSError, ValueError, KeyError, TypeError, RecursionError):
        names = json.loads(read_bounded(out / DOCUMENT, VALIDATION))["files"]
        stale |= {name for name in names if isinstance(name, str) and name == Path(name).name}
    return stale - {*_FIXED}


def write_refusal(
    error: BrakeCalError, identity: Identity, logs: Sequence[Path], out: Path
) -> None:
    """Write `REFUSED` into the folder ``out``, where earlier files stay. Raises OSError."""
    document = {
        "schema": 1,
        "identity": dict(identity),
        "logs": [printable(log.name) for log in logs],
        "program": PROGRAM,
        "error": error.to_dict(),
    }
    with work_folder(out) as work:
        write_whole(work / REFUSED, to_text(document).encode())
        publish(work, out, REFUSED)


def to_dict(outcome: StationOutcome, stored: Stored, files: list[str]) -> dict[str, Any]:
    """Return `station.json` as plain data; ``files`` are the other files of the run."""
    return {
        "schema": 1,
        "verdict": outcome.verdict,
        "identity": dict(outcome.identity),
        "vehicle": outcome.table.vehicle.name,
        "table": {"id": stored.id, "digest": stored.digest, "state": stored.state.word},
        "accepted_warnings": outcome.accepted or None,
        "golden": outcome.golden.id if outcome.golden else None,
        "program": PROGRAM,
        "counts": outcome.counts,
        "warnings": [warning_dict(warning) for warning in outcome.warnings],
        "checks": [_check(check) for check in outcome.checks],
        "figures": {name: finite_or_none(value) for name, value in outcome.figures.items()},
        "pads_of_ramp": _pads_of_ramp(outcome.table),
        "logs": [{"log": log, "digest": sha, "role": role} for role, log, sha in outcome.logs],
        "validation": validation_dict(stored, list(outcome.results)),
        "remarks": list(outcome.table.remarks),
        "files": files,
    }


def to_text(document: dict[str, Any]) -> str:
    """Return the text of `station.json` or `refused.json`."""
    return json.dumps(document, indent=2, allow_nan=False) + "\n"


def _pads_of_ramp(table: Table) -> dict[str, float]:
    """Return pad frictions [1]; the torques of an axle "per bar" are in SI, too [N m/Pa]."""
    front, rear = table.vehicle.front, table.vehicle.rear
    mu_f, mu_r = table.calibration.pad_friction_f.value, table.calibration.pad_friction_r.value
    return {
        "pad_friction_f": mu_f,
        "pad_friction_r": mu_r,
        "torque_per_bar_f": 2.0 * front.torque_gain * mu_f,
        "torque_per_bar_r": 2.0 * rear.torque_gain * mu_r,
    }


def _check(check: StationCheck) -> dict[str, Any]:
    return {
        "scope": check.scope,
        "figure": check.figure,
        "meaning": metric_of(check.figure).meaning,
        "value": finite_or_none(check.value),
        "fail": [check.low, check.high],
        "warn": [check.warn_low, check.warn_high],
        "verdict": check.verdict,
        "action": check.action if check.verdict in (FAILED, WARNING) else None,
    }


def junit_xml(outcome: StationOutcome, stored: Stored) -> bytes:
    """Return the checks as JUnit XML. All times are zero, so the same car gives the same bytes."""
    environment = templates("calib.line.station", markup=True)
    environment.filters["clean"] = _clean
    table = {"table": stored.id, "digest": stored.digest, "state": stored.state.word}
    page = environment.get_template("junit.xml.j2").render(
        checks=outcome.checks,
        counts=outcome.counts,
        identifiers={"verdict": outcome.verdict, **table, **outcome.identity},
        warnings=outcome.warnings,
    )
    return page.encode()


def _clean(text: str) -> str:
    """Replace what XML 1.0 cannot hold: the name of a log may have any characters."""
    with_spaces = text.replace(NBSP, " ")
    return "".join(c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in with_spaces)

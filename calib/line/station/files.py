"""The files of a run at the station: all of them, or none.

DIR/station.json  junit.xml  report.html  summary.json  <stop>.parquet  exports
DIR/refused.json  instead, where the car could not be judged: its identity and the reason

`station.json` is moved into place last: without it the run is not complete. It holds no time and no
path: the same logs, limits and identifiers give the same bytes.
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

DOCUMENT, JUNIT, REPORT = "station.json", "junit.xml", "report.html"
REFUSED = "refused.json"
_FIXED = (DOCUMENT, JUNIT, REPORT, "summary.json")


def export_name(form: str) -> str:
    """File name of an export of the format ``form``."""
    return f"table.{ENDINGS[form]}"


def outputs_of(stops: Sequence[str], forms: Sequence[str]) -> list[str]:
    """Every file that a run may write, with hold-outs named ``stops`` and exports ``forms``."""
    return [*_FIXED, REFUSED, *map(export_name, forms), *(f"{stop}.parquet" for stop in stops)]


def why_not_exported(stored: Stored) -> str:
    """Why the station hands this table to no ECU; "" if it does."""
    if not stored.state.released:
        return "only a released table may reach an ECU"
    beyond = ", ".join(stored.table.not_sensed)
    return f"an ECU cannot sense {beyond}; see `brake-cal tables export`" if beyond else ""


def publish_run(work: Path, out: Path) -> list[Path]:
    """Move everything from ``work`` into ``out``, the verdict last; return the paths.

    Files of an earlier run that this one did not make are removed: no export may stay when the car
    fails now. Raises OSError, see `calib.base.write.publish`.
    """
    return publish(work, out, DOCUMENT, _stale)


def _stale(out: Path) -> set[str]:
    """Every export, every file that an earlier verdict lists, and the refusal of an earlier run."""
    stale = {*map(export_name, ENDINGS), REFUSED}
    with suppress(OSError, ValueError, KeyError, TypeError, RecursionError):
        names = json.loads(read_bounded(out / DOCUMENT, VALIDATION))["files"]
        stale |= {n for n in names if isinstance(n, str) and n == Path(n).name and n not in _FIXED}
    return stale


def write_refusal(
    error: BrakeCalError, identity: Identity, logs: Sequence[Path], out: Path
) -> None:
    """Write `REFUSED` into the folder ``out``, whole or not at all. Raises OSError.

    The files of an earlier run stay; the next run that ends with a verdict removes it.
    """
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
    """The document as plain data; ``files`` are the other files in its folder."""
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
        "pads_of_ramp": _ramp(outcome.table),
        "logs": [{"log": log, "digest": sha, "role": role} for role, log, sha in outcome.logs],
        "validation": validation_dict(stored, list(outcome.results)),
        "remarks": list(outcome.table.remarks),
        "files": files,
    }


def to_text(document: dict[str, Any]) -> str:
    """The text of `station.json`."""
    return json.dumps(document, indent=2, allow_nan=False) + "\n"


def _ramp(table: Table) -> dict[str, float]:
    """Pad friction of the ramp [1], and the torque of both wheels of an axle [N m/Pa]."""
    car, cal = table.vehicle, table.calibration
    axles = ("f", car.front, cal.pad_friction_f), ("r", car.rear, cal.pad_friction_r)
    torques = {f"torque_per_bar_{x}": 2.0 * one.torque_gain * mu.value for x, one, mu in axles}
    return {f"pad_friction_{x}": mu.value for x, _, mu in axles} | torques


def _check(check: StationCheck) -> dict[str, Any]:
    j = check.judgement
    return {
        "scope": check.scope,
        "figure": check.figure,
        "meaning": metric_of(check.figure).meaning,
        "value": finite_or_none(j.value),
        "fail": [j.low, j.high],
        "warn": [j.warn_low, j.warn_high],
        "verdict": check.verdict,
        "action": check.action if check.verdict in (FAILED, WARNING) else None,
    }


def junit_xml(outcome: StationOutcome, stored: Stored) -> bytes:
    """The document. All times are zero, so that the same car gives the same bytes."""
    environment = templates("calib.line.station", markup=True)
    environment.filters["clean"] = _clean
    identifiers = {
        "verdict": outcome.verdict,
        "table": stored.id,
        "digest": stored.digest,
        "state": stored.state.word,
        **outcome.identity,
    }
    page = environment.get_template("junit.xml.j2").render(
        checks=outcome.checks,
        counts=outcome.counts,
        identifiers=identifiers,
        warnings=outcome.warnings,
    )
    return page.encode()


def _clean(text: str) -> str:
    """``text`` without characters that XML 1.0 cannot hold; a log's name may have any bytes."""
    shown = (c if c.isprintable() else "\N{REPLACEMENT CHARACTER}" for c in text.replace(NBSP, " "))
    return "".join(shown)

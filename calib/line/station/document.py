"""`station.json`: identifiers, verdict, every check, inputs. It holds no time and no path.

The same logs, limits and identifiers give the same bytes, at any time and on any computer.
"""

import json
import math
from typing import Any

from calib.base.program import PROGRAM
from calib.base.warning import to_dict as warning_dict
from calib.estimation.validate import to_dict as validation_dict
from calib.line.station.limits_file import action
from calib.line.station.station import StationCheck, StationOutcome
from calib.store.version import Stored

SCHEMA = 1


def to_dict(found: StationOutcome, stored: Stored, files: list[str]) -> dict[str, Any]:
    """The document as plain data; ``files`` are the other files in its folder."""
    return {
        "schema": SCHEMA,
        "verdict": found.verdict,
        "identity": found.identity.given(),
        "vehicle": found.table.vehicle.name,
        "table": {"id": stored.id, "digest": stored.digest, "state": stored.state.word},
        "accepted_warnings": found.accepted or None,
        "golden": found.golden or None,
        **({"golden_cars": found.golden_cars} if found.golden_cars else {}),
        "program": PROGRAM,
        "counts": found.counts(),
        "warnings": [warning_dict(warning) for warning in found.warnings],
        "checks": [_check(check) for check in found.checks],
        "figures": {name: _finite(value) for name, value in found.figures.items()},
        "logs": [
            {"log": log.name, "digest": log.digest, "role": role}
            for role, logs in (("ramp", found.ramps), ("coast", found.coasts))
            for log in logs
        ]
        + [{"log": r.log, "digest": r.digest, "role": r.role} for r in found.results],
        "validation": validation_dict(stored, list(found.results)),
        "remarks": list(found.table.remarks),
        "caveats": [warning_dict(warning) for warning in found.caveats],
        "files": files,
    }


def to_text(document: dict[str, Any]) -> str:
    """The text of `station.json`."""
    return json.dumps(document, indent=2, allow_nan=False) + "\n"


def _check(check: StationCheck) -> dict[str, Any]:
    j = check.judgement
    bad = check.verdict in ("failed", "warning")
    return {
        "scope": check.scope,
        "figure": check.figure,
        "meaning": check.meaning,
        "value": _finite(j.value),
        "fail": [j.low, j.high],
        "warn": [j.warn_low, j.warn_high],
        "verdict": check.verdict,
        "action": action(check.figure) if bad else None,
    }


def _finite(value: float | None) -> float | None:
    return None if value is None or not math.isfinite(value) else float(value)

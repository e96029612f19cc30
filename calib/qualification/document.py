"""A qualification as one JSON document, and the digest of its results."""

import hashlib
from dataclasses import asdict, dataclass
from typing import Any

from calib.files.digest import canonical_json
from calib.program import NAME, VERSION
from calib.qualification.check import Outcome
from calib.qualification.environment import environment, packages
from calib.qualification.suite import Qualification
from calib.qualification.use_cases import USE_CASES

SCHEMA = 1


@dataclass(frozen=True)
class Surroundings:
    """When the suite ran [UTC, ISO 8601], and on what."""

    date: str
    environment: dict[str, str]
    packages: dict[str, str]


def surroundings(date: str) -> Surroundings:
    """Those of this process."""
    return Surroundings(date, environment(), packages())


def digest(outcomes: tuple[Outcome, ...]) -> str:
    """SHA-256 [hex] over the outcomes, each rounded to its tolerance.

    Equal on machines whose libraries round differently, as long as a value is not at the border
    between two steps; it changes with a check, an expected value, or a result that moves by one
    tolerance.
    """
    results = [
        [o.check.name, o.check.expected, o.check.tolerance, o.held, o.rounded] for o in outcomes
    ]
    return hashlib.sha256(canonical_json({"schema": SCHEMA, "results": results})).hexdigest()


def to_dict(found: Qualification, at: Surroundings) -> dict[str, Any]:
    """`qualification.json`."""
    return {
        "schema": SCHEMA,
        "tool": NAME,
        "version": VERSION,
        "date": at.date,
        "verdict": verdict(found),
        "digest": digest(found.outcomes),
        "environment": at.environment,
        "packages": at.packages,
        "use_cases": [asdict(case) for case in USE_CASES],
        "checks": [_entry(outcome) for outcome in found.outcomes],
        "left_out": [{"name": c.name, "missing": list(c.missing)} for c in found.left_out],
        "files": found.files,
    }


def verdict(found: Qualification) -> str:
    """`passed` or `failed`."""
    return "passed" if found.passed else "failed"


def _entry(outcome: Outcome) -> dict[str, Any]:
    check = outcome.check
    return {
        "name": check.name,
        "quantity": check.quantity,
        "unit": check.unit,
        "expected": check.expected,
        "tolerance": check.tolerance,
        "value": outcome.value,
        "held": outcome.held,
        "truth": check.truth,
        "error": outcome.error,
    }

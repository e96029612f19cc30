"""Limits of a validation, from a TOML file: which figure may be how large.

    schema = 1
    [limits]
    torque_error_f = { max = 0.05 }
    valid_share = { min = 0.7 }

A figure that a log cannot give (no truth, say) is not judged and says so.
"""

import math
from dataclasses import dataclass
from pathlib import Path

from calib.errors import LimitsError
from calib.toml import did_you_mean, read_toml

SCHEMA = 1


@dataclass(frozen=True)
class Limit:
    """A figure's allowed range; either end may be open (None)."""

    figure: str
    low: float | None
    high: float | None


@dataclass(frozen=True)
class Judgement:
    """A limit and what came: ``passed`` is None where the log cannot give the figure."""

    figure: str
    value: float | None
    low: float | None
    high: float | None
    passed: bool | None


DEFAULTS: tuple[Limit, ...] = (
    Limit("valid_share", 0.7, None),
    Limit("covered_share", 0.5, None),
    Limit("pad_friction_drift_f", None, 0.10),
    Limit("pad_friction_drift_r", None, 0.20),
    Limit("interval_f", None, 0.10),
    Limit("interval_r", None, 0.25),
    Limit("torque_error_f", None, 0.03),
    Limit("torque_error_r", None, 0.08),
    Limit("truth_in_interval", 0.80, None),
)
"""What a stop must hold when the user gives no limits. Errors count only where a log has truth."""


def read_limits(path: Path, known: set[str]) -> tuple[Limit, ...]:
    """Read limits. Raises LimitsError for an unreadable file, an unknown figure or a bad range."""
    document = read_toml(path, SCHEMA, LimitsError)
    extra = sorted(set(document) - {"limits"})
    if extra:
        raise LimitsError(f"unknown key {extra[0]!r}", where=path, expected="[limits]")
    table = document.get("limits")
    if not isinstance(table, dict) or not table:
        raise LimitsError("no limits in it", where=path, expected="a table [limits]")
    return tuple(_limit(path, name, spec, known) for name, spec in table.items())


def _limit(path: Path, name: str, spec: object, known: set[str]) -> Limit:
    if name not in known:
        hint = did_you_mean(name, sorted(known)) or f"known: {', '.join(sorted(known))}"
        raise LimitsError(f"unknown figure {name!r}", where=path, do=hint)
    if not isinstance(spec, dict) or not spec or set(spec) - {"min", "max"}:
        raise LimitsError(
            f"{name} = {spec!r}", where=path, expected="{ min = NUMBER } and/or { max = NUMBER }"
        )
    ends = {key: spec.get(key) for key in ("min", "max")}
    for key, value in ends.items():
        if value is not None and not _is_number(value):
            raise LimitsError(f"{name}.{key} = {value!r}", where=path, expected="a finite number")
    low, high = ends["min"], ends["max"]
    if low is not None and high is not None and low > high:
        raise LimitsError(f"{name}: min {low} lies above max {high}", where=path)
    return Limit(name, None if low is None else float(low), None if high is None else float(high))


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and math.isfinite(value)


def judge(limits: tuple[Limit, ...], figures: dict[str, float | None]) -> tuple[Judgement, ...]:
    """Hold the figures against the limits, in the order of the limits."""
    out = []
    for limit in limits:
        value = figures.get(limit.figure)
        passed = None
        if value is not None:
            above = limit.low is None or value >= limit.low
            below = limit.high is None or value <= limit.high
            passed = above and below
        out.append(Judgement(limit.figure, value, limit.low, limit.high, passed))
    return tuple(out)

"""Limits of a validation, from a TOML file: which figure may be how large.

    schema = 1
    [limits]
    torque_error_f = { max = 0.05 }
    valid_share = { min = 0.7 }

Between pass and fail there may be a warning: `pad_scale = { fail = [0.8, 1.2], warn = [0.9, 1.1] }`
fails outside the first range and warns outside the second; `-inf` and `inf` leave an end open, and
`min`, `max` are another word for the ends of `fail`. A figure that a log cannot give (no truth,
say) is not judged and says so; with `required = true` it fails.
"""

import math
from dataclasses import dataclass
from pathlib import Path

from calib.errors import LimitsError
from calib.toml import did_you_mean, read_toml

SCHEMA = 1
PASSED, WARNING, FAILED, NOT_KNOWN = "passed", "warning", "failed", "not known"
"""Verdicts of a judgement."""

Range = tuple[float | None, float | None]


@dataclass(frozen=True)
class Limit:
    """A figure's allowed range; any end may be open (None).

    Outside ``low`` to ``high`` it fails, outside ``warn_low`` to ``warn_high`` it warns. A
    ``required`` figure that is not known fails.
    """

    figure: str
    low: float | None
    high: float | None
    warn_low: float | None = None
    warn_high: float | None = None
    required: bool = False


@dataclass(frozen=True)
class Judgement:
    """A limit and what came: ``passed`` is None where the log cannot give the figure.

    ``warned``: it passed, but lies outside ``warn_low`` to ``warn_high``.
    """

    figure: str
    value: float | None
    low: float | None
    high: float | None
    passed: bool | None
    warn_low: float | None = None
    warn_high: float | None = None
    warned: bool = False

    @property
    def verdict(self) -> str:
        """`passed`, `warning`, `failed` or `not known`."""
        if self.passed is None:
            return NOT_KNOWN
        if not self.passed:
            return FAILED
        return WARNING if self.warned else PASSED


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


EXPECTED = (
    "{ min = NUMBER } and/or { max = NUMBER }, or { fail = [LOW, HIGH] } and/or "
    "{ warn = [LOW, HIGH] }; with required = true it must be known"
)
KEYS = {"min", "max", "fail", "warn", "required"}


def _limit(path: Path, name: str, spec: object, known: set[str]) -> Limit:
    if name not in known:
        hint = did_you_mean(name, sorted(known)) or f"known: {', '.join(sorted(known))}"
        raise LimitsError(f"unknown figure {name!r}", where=path, do=hint)
    if not isinstance(spec, dict) or not set(spec) - {"required"} or set(spec) - KEYS:
        raise LimitsError(f"{name} = {spec!r}", where=path, expected=EXPECTED)
    if "fail" in spec and ("min" in spec or "max" in spec):
        raise LimitsError(
            f"{name} has both fail and {'min' if 'min' in spec else 'max'}",
            where=path,
            expected="one of them: they say the same",
        )
    required = spec.get("required", False)
    if not isinstance(required, bool):
        raise LimitsError(f"{name}.required = {required!r}", where=path, expected="true or false")
    low, high = _pair(path, name, "fail", spec) if "fail" in spec else _ends(path, name, spec)
    warn_low, warn_high = _pair(path, name, "warn", spec) if "warn" in spec else (None, None)
    for warn, fail, sign in ((warn_low, low, 1.0), (warn_high, high, -1.0)):
        if warn is not None and fail is not None and sign * warn < sign * fail:
            raise LimitsError(
                f"{name}: warn {warn:g} lies beyond fail {fail:g}",
                where=path,
                expected="warn inside fail: it comes first",
            )
    return Limit(name, low, high, warn_low, warn_high, required)


def _ends(path: Path, name: str, spec: dict[str, object]) -> Range:
    """``min`` and ``max``, finite both."""
    for key in ("min", "max"):
        value = spec.get(key)
        if value is not None and not (_is_number(value) and math.isfinite(float(str(value)))):
            raise LimitsError(f"{name}.{key} = {value!r}", where=path, expected="a finite number")
    low, high = (None if spec.get(k) is None else float(str(spec[k])) for k in ("min", "max"))
    if low is not None and high is not None and low > high:
        raise LimitsError(f"{name}: min {low:g} lies above max {high:g}", where=path)
    return low, high


def _pair(path: Path, name: str, key: str, spec: dict[str, object]) -> Range:
    """A range [low, high]; an infinite end is open (None)."""
    value = spec[key]
    if not (isinstance(value, list) and len(value) == 2 and all(map(_is_number, value))):
        raise LimitsError(
            f"{name}.{key} = {value!r}", where=path, expected="[LOW, HIGH]; -inf, inf: no limit"
        )
    low, high = float(value[0]), float(value[1])
    if low > high or low == math.inf or high == -math.inf:
        raise LimitsError(f"{name}.{key}: {low:g} to {high:g} is no range", where=path)
    return (None if low == -math.inf else low), (None if high == math.inf else high)


def _is_number(value: object) -> bool:
    return isinstance(value, int | float) and not isinstance(value, bool) and value == value


def judge(limits: tuple[Limit, ...], figures: dict[str, float | None]) -> tuple[Judgement, ...]:
    """Hold the figures against the limits, in the order of the limits."""
    out = []
    for limit in limits:
        value = figures.get(limit.figure)
        passed, warned = False if limit.required else None, False
        if value is not None:
            passed = _within(value, limit.low, limit.high)
            warned = passed and not _within(value, limit.warn_low, limit.warn_high)
        out.append(
            Judgement(
                limit.figure,
                value,
                limit.low,
                limit.high,
                passed,
                limit.warn_low,
                limit.warn_high,
                warned,
            )
        )
    return tuple(out)


def _within(value: float, low: float | None, high: float | None) -> bool:
    return (low is None or value >= low) and (high is None or value <= high)

"""A check in words: value, limit and verdict, for people and for line systems."""

from calib.base.plain import plain
from calib.estimation.limits import FAILED, NOT_KNOWN, WARNING
from calib.line.station.metrics import CUT
from calib.line.station.station import StationCheck, StationOutcome

HEADINGS = {
    "passed": "Passed",
    "warning": "Passed with warnings",
    "failed": "Failed",
    "refused": "Refused",
}
"""The verdict on a car, as a heading; refused: it has none."""


def shown(value: float | None, digits: int = 4) -> str:
    """A value with ``digits`` significant digits."""
    return "not known" if value is None else f"{value:.{digits}g}"


def value_of(check: StationCheck, digits: int = 4) -> str:
    """The value of a check with ``digits`` digits, and `or more` where it is at its `CUT`."""
    return shown(check.judgement.value, digits) + " or more" * _beyond(check)


def _beyond(check: StationCheck) -> bool:
    """Whether the value stands for all larger ones."""
    value = check.judgement.value
    return value is not None and value == CUT.get(check.figure)


def bounds(low: float | None, high: float | None) -> str:
    """A range in words: `0.8 to 1.2`, `at least 0.7`, `at most 0.1`.

    >>> bounds(None, 0.1)
    'at most 0.1'
    """
    if low is None and high is None:
        return "none"
    if low is None or high is None:
        return f"at most {high:g}" if high is not None else f"at least {low:g}"
    return f"{low:g} to {high:g}"


def sentence(check: StationCheck) -> str:
    """A check as a sentence: `side_difference_f of the car is 0.31; the limit is -0.2 to 0.2`."""
    of = "of the car" if check.of_car else f"of the stop {check.scope}"
    if check.judgement.value is None:
        return f"{check.figure} {of} is not known, and it is required"
    kind = "a warning is given outside" if check.verdict == WARNING else "the limit is"
    return f"{check.figure} {of} is {value_of(check)}; {kind} {_limit(check)}"


def in_full(check: StationCheck) -> str:
    """The same in plain names and units: `Front brakes, left less right: 31 %; limit: ...`."""
    of = "" if check.of_car else f"stop {check.scope}, "
    kind = "no warning" if check.verdict == WARNING else "limit"
    shown = plain(check.figure)
    value = shown.with_unit(check.judgement.value) + " or more" * _beyond(check)
    return f"{of}{shown.name}: {value}; {kind}: {shown.bounds(*_ends(check))}"


def _limit(check: StationCheck) -> str:
    return bounds(*_ends(check))


def _ends(check: StationCheck) -> tuple[float | None, float | None]:
    """The range that decided the verdict: that of the warning for a warning."""
    j = check.judgement
    return (j.warn_low, j.warn_high) if check.verdict == WARNING else (j.low, j.high)


def summary(found: StationOutcome) -> str:
    """The verdict in a sentence with its counts."""
    n = found.counts()
    parts = [f"{n[FAILED]} failed", f"{n[WARNING]} with a warning", f"{n[NOT_KNOWN]} not known"]
    named = [part for part in parts if not part.startswith("0 ")]
    text = f"{len(found.checks)} checks: " + (", ".join(named) or "all passed")
    count = len(found.warnings)
    return f"{text}; {count} warning{'s' * (count > 1)} of its logs" if count else text

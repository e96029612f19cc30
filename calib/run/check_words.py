"""A check in one line: the verdict first, then the log, then what speaks against it."""

from calib.run.check import Findings, LogVerdict

FOR = {
    "fit": "fit",
    "validate": "validate",
    "coast": "fit as a coast log",
    "diagnose": "diagnose",
}
"""Each purpose as it is told."""


def verdict(findings: Findings) -> str:
    """For what a log is usable: ``usable for validate, diagnose``, or ``not usable``."""
    told = [FOR[one.purpose] for one in findings.verdicts if one.usable]
    return f"usable for {', '.join(told)}" if told else "not usable"


def line(findings: Findings) -> str:
    """The verdict on a log, with the reason why it makes no table, and its warnings by code."""
    why, codes = _why(findings), dict.fromkeys(one.code for one in findings.warnings)
    parts = [why] if why else []
    if codes:
        parts.append(f"warning{'s' * (len(codes) > 1)}: {', '.join(codes)}")
    return "; ".join([f"{verdict(findings)}: {findings.source}", *parts])


def _why(findings: Findings) -> str:
    """Why a run with a braking makes no table, or why a log serves for nothing; may be empty."""
    fit = _of(findings, "fit")
    if fit.usable or (findings.usable and not findings.seen.events):
        return ""
    reasons = fit.reasons if findings.seen.events else _nearest(findings).reasons
    more = f" (and {len(reasons) - 1} more)" if len(reasons) > 1 else ""
    if findings.usable:  # what is missing for a table, not what to do about it
        return f"no fit: {reasons[0].partition(': ')[0]}{more}"
    return f"{reasons[0]}{more}"


def _nearest(findings: Findings) -> LogVerdict:
    """The verdict with the fewest reasons; the first of several."""
    return min(findings.verdicts, key=lambda one: len(one.reasons))


def _of(findings: Findings, purpose: str) -> LogVerdict:
    return next(one for one in findings.verdicts if one.purpose == purpose)

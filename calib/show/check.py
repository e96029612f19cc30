"""Facts of a check: for what each log is usable, and what is in it."""

from collections.abc import Sequence

from calib.plausibility.check import Findings
from calib.plausibility.check import facts as contents
from calib.show.facts import Facts, Row

_FOR = {
    "fit": "fit",
    "validate": "validate",
    "coast": "fit as a coast log",
    "diagnose": "diagnose",
}
"""Each purpose as it is told."""


def facts(found: Sequence[Findings]) -> Facts:
    """A line for each log, and what it contains."""
    parts = [Facts(title=one.run.log.source, rows=_rows(one)) for one in found]
    return Facts(notes=[line(one) for one in found], parts=parts)


def line(findings: Findings) -> str:
    """The verdict on a log, with the reason why it makes no table, and its warnings by code."""
    why, codes = _why(findings), dict.fromkeys(one.code for one in findings.warnings)
    parts = [why] if why else []
    if codes:
        parts.append(f"warning{'s' * (len(codes) > 1)}: {', '.join(codes)}")
    told = [_FOR[one.purpose] for one in findings.verdicts if one.usable]
    verdict = f"usable for {', '.join(told)}" if told else "not usable"
    return "; ".join([f"{verdict}: {findings.run.log.source}", *parts])


def _why(findings: Findings) -> str:
    """Why a run with a braking makes no table, or why a log serves for nothing; may be empty."""
    fit = next(one for one in findings.verdicts if one.purpose == "fit")
    if fit.usable or (findings.usable and not findings.run.events):
        return ""
    fewest = min((one.reasons for one in findings.verdicts), key=len)
    reasons = fit.reasons if findings.run.events else fewest
    more = f" (and {len(reasons) - 1} more)" if len(reasons) > 1 else ""
    if findings.usable:  # what is missing for a table, not what to do about it
        return f"no fit: {reasons[0].partition('; ')[0]}{more}"
    return f"{reasons[0]}{more}"


def _rows(findings: Findings) -> list[Row]:
    return [
        *contents(findings),
        *(("read", note) for note in findings.run.log.notes),
        *(("warning", warning.text) for warning in findings.warnings),
        ("usable", "as far as can be told without a vehicle file"),
        *(
            (v.purpose, "; ".join(["usable" if v.usable else "not usable", *v.reasons]))
            for v in findings.verdicts
        ),
    ]

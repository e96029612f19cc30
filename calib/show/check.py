"""Facts of a check: for what each log can be used, what speaks against it, and what it holds."""

from collections.abc import Sequence

from calib.base.plain import counted
from calib.plausibility.check import Findings, contents
from calib.show.facts import Facts, Row


def check_facts(findings: Sequence[Findings]) -> Facts:
    """Return a line for each log, a part with its content, and what to do with a single log."""
    warnings = findings[0].warnings if len(findings) == 1 else ()
    return Facts(
        notes=[_line(log) for log in findings],
        next=warnings[0].do if warnings else "",
        parts=[Facts(title=log.run.log.source, rows=_rows(log)) for log in findings],
    )


def _line(findings: Findings) -> str:
    """Return the verdict on a log, why no table can be fitted, and the titles of its warnings."""
    why, titles = _why(findings), dict.fromkeys(warning.title for warning in findings.warnings)
    texts = [why] if why else []
    if titles:
        texts.append(f"{counted(len(titles), 'warning')}: {', '.join(titles)}")
    purposes = ", ".join(verdict.purpose for verdict in findings.verdicts if verdict.usable)
    usable = f"usable for {purposes.replace('coast', 'fit as a coast log')}"
    verdict = usable if purposes else "not usable"
    return "; ".join([f"{verdict}: {findings.run.log.source}", *texts])


def _why(findings: Findings) -> str:
    """Return why a braking cannot be fitted, or why a log is of no use; "" if neither is so."""
    verdicts, brakings = findings.verdicts, findings.run.events
    fit = next(verdict for verdict in verdicts if verdict.purpose == "fit")
    if fit.usable or (findings.usable and not brakings):
        return ""
    reasons = fit.reasons
    if not brakings:  # of no use: take the purpose that the fewest reasons exclude
        reasons = min((verdict.reasons for verdict in verdicts), key=len)
    more = f" (and {len(reasons) - 1} more)" if len(reasons) > 1 else ""
    if findings.usable:
        reason, _, _ = reasons[0].partition("; ")  # the second half says what to do
        return f"no fit: {reason}{more}"
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

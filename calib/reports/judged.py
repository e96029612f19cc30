"""Rows of judged metrics for a page: plain name, value, bar, limits, verdict; the worst first."""

from collections.abc import Sequence
from dataclasses import dataclass

from calib.messages.plain import METRICS, Plain, plain
from calib.messages.warning import PlausibilityWarning
from calib.reports.bar import Bar, bar
from calib.validation.limits import FAILED, NOT_KNOWN, PASSED, WARNING, Judgement

WORST_FIRST = (FAILED, WARNING, PASSED, NOT_KNOWN)
KINDS = {FAILED: "failed", WARNING: "warning", PASSED: "passed", NOT_KNOWN: "unjudged"}
"""Class of a row by its verdict."""


@dataclass(frozen=True)
class JudgedRow:
    """One metric: ``key`` is its name in the files; ``kind`` the class of the row."""

    name: str
    key: str
    value: str
    bar: Bar | None
    limit: str
    warn: str
    verdict: str
    kind: str


def row(judgements: Sequence[Judgement], most: float | None = None) -> JudgedRow:
    """The row of one metric, judged once or stop by stop with the same limits.

    ``most``: a value that stands for all larger ones.
    """
    first = judgements[0]
    shown = plain(first.figure)
    values = [_value(shown, j.value, most) for j in judgements]
    words = {j.verdict for j in judgements}
    verdict = next(word for word in WORST_FIRST if word in words)
    text = values[0] if len({*values}) == 1 else ", ".join(values)
    limit = shown.bounds(first.low, first.high)
    warn = shown.bounds(first.warn_low, first.warn_high)
    unit = f" {shown.unit}" if shown.unit and text != "not known" else ""
    drawn = bar(
        [j.value for j in judgements],
        (first.low, first.high),
        (first.warn_low, first.warn_high),
        f"{text}{unit}; limit {limit}",
    )
    return JudgedRow(
        shown.name,
        first.figure,
        text + unit,
        drawn,
        "" if limit == "none" else limit,
        "" if warn == "none" else warn,
        verdict,
        KINDS[verdict],
    )


def sorted_rows(rows: Sequence[JudgedRow]) -> list[JudgedRow]:
    """The rows with the worst verdict first, else in their order."""
    return sorted(rows, key=lambda row: WORST_FIRST.index(row.verdict))


def warned(w: PlausibilityWarning) -> tuple[str, ...]:
    """A warning as a row: what and where, measured and expected, likely causes, what to do."""
    known = METRICS.get(w.code)
    name, amount, expected = w.code.replace("_", " "), w.amount, w.bounds
    if known is not None:
        name, amount, expected = known.name, known.with_unit(w.measured), known.bounds(*w.expected)
    return f"{w.log}: {name}", f"{amount}; expected {expected}", ", or ".join(w.causes), w.do


def _value(shown: Plain, value: float | None, most: float | None) -> str:
    return shown.value(value) + " or more" * (value is not None and value == most)

"""Rows of judged metrics for a page: plain name, value, bar, limits, verdict; the worst first.

A value within its limits as a bar: where it may be, where a warning begins, where it is.

failed | warning |        passed        | warning | failed
░░░░░░░▒▒▒▒▒▒▒▒▒▒████████████▼███████████▒▒▒▒▒▒▒▒▒▒░░░░░░░░
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from calib.base.plain import METRICS, Plain, plain
from calib.base.warning import PlausibilityWarning
from calib.estimation.limits import FAILED, NOT_KNOWN, PASSED, WARNING, Judgement
from calib.show.facts import Bar, Table
from calib.show.html import Report

ROOM = 0.3
"""Part of the bar beyond each limit, over the range within them."""
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


def judged(
    caption: str, groups: Sequence[Sequence[Judgement]], most: Mapping[str, float] | None = None
) -> tuple[Table, list[str]]:
    """One row for each metric, judged once or stop by stop, and a note on what is not known.

    ``most``: values that stand for all larger ones, by metric.
    """
    rows = sorted_rows([row(group, (most or {}).get(group[0].figure)) for group in groups])
    known = [r for r in rows if r.verdict != NOT_KNOWN]
    cells = [(r.name, r.value, r.limit, r.warn, r.verdict, r.key) for r in known]
    heads = ("metric", "value", "limit", "no warning", "verdict", "key")
    table = Table(heads, cells, caption, [r.kind for r in known], [r.bar for r in known])
    unknown = ", ".join(r.name for r in rows if r.verdict == NOT_KNOWN)
    return table, [f"Not known and so not judged: {unknown}."] * bool(unknown)


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


def judged_rows(page: Report, caption: str, rows: Sequence[JudgedRow]) -> None:
    """The table of ``rows``, and the names of those that are not known."""
    if known := [r for r in rows if r.verdict != NOT_KNOWN]:
        page.add("judged", caption, known)
    if unknown := [r.name for r in rows if r.verdict == NOT_KNOWN]:
        page.add("small", f"Not known and so not judged: {', '.join(unknown)}.")


def bar(
    values: Sequence[float | None],
    fail: tuple[float | None, float | None],
    warn: tuple[float | None, float | None],
    label: str,
) -> Bar | None:
    """The bar of ``values`` with their limits (low, high), None for an open end.

    None without any limit, and without any value.
    """
    known = [v for v in values if v is not None and math.isfinite(v)]
    ends = [x for x in (*fail, *warn) if x is not None]
    if not ends or not known:
        return None
    low, high = _axis(known, fail, warn)

    def place(x: float | None, open_end: float) -> float:
        at = open_end if x is None else min(max(x, low), high)
        return round(100.0 * (at - low) / (high - low), 2)

    held = place(fail[0], low), place(fail[1], high)
    calm = (
        max(held[0], place(warn[0], low)),
        min(held[1], place(warn[1], high)),
    )
    return Bar(
        (calm[0], round(max(calm[1] - calm[0], 0.0), 2)),
        (held[0], round(max(held[1] - held[0], 0.0), 2)),
        tuple(place(v, low) for v in known),
        label,
    )


def _axis(
    known: list[float],
    fail: tuple[float | None, float | None],
    warn: tuple[float | None, float | None],
) -> tuple[float, float]:
    """Ends of the bar: all limits with room beyond them; zero, if only one side has a limit."""
    lows = [x for x in (fail[0], warn[0]) if x is not None]
    highs = [x for x in (fail[1], warn[1]) if x is not None]
    if lows and highs:
        low, high = min(lows), max(highs)
        room = ROOM * ((high - low) or 1.0)
        return low - room, high + room
    if highs:
        return min(0.0, *known), max(highs) * (1.0 + ROOM) if max(highs) > 0.0 else 1.0
    top = max(*lows, min(max(known), 2.0 * max(lows)))
    return min(0.0, *lows), top * (1.0 + 0.1) if top > 0.0 else 1.0

"""The report of a fleet: one HTML file with its pictures, and a JSON document."""

from collections.abc import Mapping
from typing import Any

import numpy as np

from calib.fleet import control_chart, outliers, tails
from calib.fleet.control_chart import BY_CHANCE, FEWEST_BY_CHANCE, RULES
from calib.fleet.outliers import Spread
from calib.fleet.summary import DRIFT, Look, Summary
from calib.reports.html import page, picture

NAMES = 50
"""Number of outliers in the page; fleet.json has all."""


def headline(found: Summary) -> str:
    """The fleet in one sentence."""
    if _too_few(found):
        some = any(look.spread.count for look in found.looks)
        why = "too few to judge outliers or drift" if some else "none has a metric"
        text = f"{_count(len(found.logs), 'log', 'logs')}: {why}"
        return text + f"; {_errors(found)}." if found.failures else text + "."
    drifting = [look.metric.name for look in found.looks if look.drifts]
    logs = len({outlier.log for outlier in found.outliers})
    steady = "No drift" if _drift_tested(found) else "Drift not tested"
    parts = [
        f"{', '.join(drifting)} {'drift' if len(drifting) > 1 else 'drifts'}"
        if drifting
        else steady,
        f"{_count(logs, 'log stands', 'logs stand')} apart" if logs else "no log stands apart",
    ]
    if found.failures:
        parts.append(_errors(found))
    return "; ".join(parts) + "."


def _errors(found: Summary) -> str:
    return f"{_count(sum(f.count for f in found.failures), 'log', 'logs')} with an error"


def _too_few(found: Summary) -> bool:
    """Whether no metric has enough logs to be judged."""
    counts = [look.spread.count for look in found.looks]
    return max(counts, default=0) < min(outliers.FEWEST, control_chart.FEWEST)


def _drift_tested(found: Summary) -> bool:
    return any(look.change is not None for look in found.looks)


def report_html(found: Summary, title: str, pictures: Mapping[str, bytes]) -> str:
    """Return the page; ``pictures`` PNG by name of metric."""
    return page(
        "fleet",
        title=f"{title}: fleet",
        name=title,
        kind=_kind(found),
        headline=headline(found),
        status=[("logs", len(found.logs)), *found.status.items()],
        errors=[(f.message, f.count, ", ".join(f.logs)) for f in found.failures],
        too_few=_too_few(found),
        outliers=len(found.outliers),
        farthest=[
            (o.log, o.metric, f"{o.value:.4g}", f"{o.z:+.1f}", f"{o.p:.1e}")
            for o in found.outliers[:NAMES]
        ],
        overview=[_row(look) for look in found.looks],
        figures=[
            (look.metric.name, picture(pictures[look.metric.name], "png"), described(found, look))
            for look in _first(found)
        ],
        classes=[
            (s.metric.name, ", ".join(f"{text}: {count}" for text, count in s.counts))
            for s in found.shares
        ],
        ordered_by=found.ordered_by,
        share=outliers.SHARE,
        fewest=outliers.FEWEST,
        fewest_tails=tails.FEWEST,
        fewest_by_chance=FEWEST_BY_CHANCE,
        drift=DRIFT,
        rules=RULES,
    )


def _first(found: Summary) -> list[Look]:
    """Metrics with drift first, then those with outliers, then the others that have values."""
    filled = [look for look in found.looks if look.values.size]
    return sorted(filled, key=lambda look: (not look.drifts, not look.outlying.any()))


def _kind(found: Summary) -> str:
    """The verdict that sets the colour of the page's head."""
    calm = not (any(look.drifts for look in found.looks) or found.outliers or found.failures)
    if _too_few(found) or (calm and not _drift_tested(found)):
        return "unknown"
    return "no_gap" if calm else "ambiguous"


def _row(look: Look) -> tuple[str, ...]:
    """One metric as a row of the table of all metrics."""
    s, judged = look.spread, bool(np.isfinite(look.spread.z).any())
    if not s.count:
        return (look.metric.name, look.metric.unit, "0", *("",) * 6)
    tested = look.change and f"{'yes' if look.drifts else 'no'}, p {look.change.p:.1e}"
    return (
        look.metric.name,
        look.metric.unit,
        str(s.count),
        number(s.median, s),
        f"{s.scale:.2g}",
        f"{number(s.quantiles[0], s)} to {number(s.quantiles[3], s)}",
        f"{s.beyond} / {s.expected:.1f}" if judged else "",
        str(int(look.outlying.sum())) if judged else "not judged",
        tested or "not tested",
    )


def described(found: Summary, look: Look) -> str:
    """One metric in words: median and range, drift, number of broken run rules."""
    s, unit = look.spread, "" if look.metric.unit == "1" else f" {look.metric.unit}"
    low, high = number(s.quantiles[0], s), number(s.quantiles[3], s)
    parts = [f"Median {number(s.median, s)}{unit}, 90 % of the logs from {low} to {high}{unit}."]
    if look.drifts and look.change is not None:
        c = look.change
        parts.append(
            f"The level changes from {number(c.before, s)} to {number(c.after, s)}{unit} about "
            f"{found.logs[look.rows[c.first]]}, number {look.rows[c.first] + 1} of the line "
            f"(p {c.p:.1e})."
        )
    if look.chart is not None:
        broken_rules = []
        for rule in RULES:
            broken, chance = int(look.chart.alarms[rule].sum()), _by_chance(look, rule)
            broken_rules.append(
                f"rule {rule}: {broken}" + ("" if chance is None else f" ({chance:.1f} by chance)")
            )
        parts.append(f"Run rules broken: {'; '.join(broken_rules)}.")
    elif look.metric.name == found.ordered_by:
        parts.append("The logs are ordered by it, so it has no control chart and cannot drift.")
    else:
        parts.append("No control chart: too few logs, or no scatter.")
    return " ".join(parts)


def _by_chance(look: Look, rule: int) -> float | None:
    """How often a steady line would break ``rule``; None where there are too few logs to say."""
    n = look.values.size
    return BY_CHANCE[rule] * n if n >= FEWEST_BY_CHANCE else None


def number(value: float, about: Spread) -> str:
    """``value`` rounded to one digit below the scatter of its metric, at least four digits."""
    width = max(about.quantiles[3] - about.quantiles[0], 1e-300)
    digits = 4
    if value:
        digits = max(4, 3 + int(np.floor(np.log10(abs(value)) - np.log10(width))))
    return f"{value:.{min(digits, 10)}g}"


def document(found: Summary) -> dict[str, Any]:
    """The whole summary as one JSON-able document."""
    return {
        "schema": 1,
        "logs": len(found.logs),
        "ordered_by": found.ordered_by,
        "status": found.status,
        "headline": headline(found),
        "errors": found.failures,
        "outliers": [
            {"log": o.log, "figure": o.metric, "value": o.value, "z": o.z, "p": o.p}
            for o in found.outliers
        ],
        "outliers_by_chance": outliers.SHARE * len(found.outliers),
        "figures": {look.metric.name: _entry(found, look) for look in found.looks},
        "classes": {s.metric.name: dict(s.counts) for s in found.shares},
    }


def _entry(found: Summary, look: Look) -> dict[str, Any]:
    s, c = look.spread, look.change
    return {
        "unit": look.metric.unit,
        "count": s.count,
        "median": s.median,
        "scale": s.scale,
        "quantiles": dict(zip(("5", "25", "75", "95"), s.quantiles, strict=True)),
        "beyond_3": {"count": s.beyond, "by_chance": s.expected},
        "outliers": int(look.outlying.sum()),
        "chart": look.chart
        and {
            "centre": look.chart.centre,
            "limits": look.chart.limits,
            "rules": {
                str(rule): {
                    "broken": int(look.chart.alarms[rule].sum()),
                    "by_chance": _by_chance(look, rule),
                }
                for rule in RULES
            },
        },
        "change": c
        and {
            "drifts": look.drifts,
            "p": c.p,
            "first_log": found.logs[look.rows[c.first]],
            "number": int(look.rows[c.first]) + 1,
            "before": c.before,
            "after": c.after,
        },
    }


def _count(number: int, one: str, many: str) -> str:
    return f"{number} {one if number == 1 else many}"

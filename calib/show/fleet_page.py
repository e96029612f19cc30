"""Facts of a fleet, and its JSON document."""

from collections.abc import Callable
from dataclasses import replace
from typing import Any

import numpy as np

from calib.base.plain import METRICS, NBSP, counted, plain
from calib.line.fleet import control_chart, outliers
from calib.line.fleet.control_chart import BY_CHANCE, FEWEST_BY_CHANCE, RULES
from calib.line.fleet.outliers import MetricSpread
from calib.line.fleet.summary import DRIFT, Look, Outlier, Summary, in_words
from calib.show.facts import PASSED, UNJUDGED, WARNING, Facts, Picture, Table
from calib.show.fleet_figure import sheet

NAMES = 50
"""Number of logs that stand apart in the page; fleet.json has all."""
HEADS = (
    *("metric", "logs", "median", "90 % of the logs", "one more is named", "stand apart", "drift"),
)


def headline(found: Summary) -> str:
    """The fleet in one sentence."""
    errors = sum(failure.count for failure in found.failures)
    failed = f"; {counted(errors, 'log')} with an error" if errors else ""
    if _too_few(found):
        some = any(look.spread.count for look in found.looks)
        why = "too few to judge outliers or drift" if some else "none has a metric"
        return f"{counted(len(found.logs), 'log')}: {why}{failed}."
    names, logs = [_name(look) for look in found.looks if look.drifts], len(found.apart)
    drift = "No drift" if _drift_tested(found) else "Drift not tested"
    if names:
        drift = f"{', '.join(names)} {'drift' if len(names) > 1 else 'drifts'}"
    apart = f"{counted(logs, 'log')} {'stands' if logs == 1 else 'stand'}"
    return f"{drift}; {apart if logs else 'no log stands'} apart{failed}."


def _too_few(found: Summary) -> bool:
    """Whether no metric has enough logs to be judged."""
    counts = [look.spread.count for look in found.looks]
    return max(counts, default=0) < min(outliers.FEWEST, control_chart.FEWEST)


def _drift_tested(found: Summary) -> bool:
    return any(look.change is not None for look in found.looks)


def facts(found: Summary, title: str = "") -> Facts:
    """A fleet, the logs that stand apart first."""
    looks = [look for look in found.looks if look.spread.count]
    apart = [(car.log, "; ".join(reason(found, o) for o in car.reasons)) for car in found.apart]
    more = len(apart) - NAMES
    errors = [(f.message, str(f.count), ", ".join(f.logs)) for f in found.failures]
    classes = [
        (plain(s.metric.name).name, ", ".join(f"{_class(text)}: {n}" for text, n in s.counts))
        for s in found.shares
    ]
    return Facts(
        title,
        headline=headline(found),
        verdict=_kind(found),
        numbers=[("logs", str(len(found.logs))), *((k, str(n)) for k, n in found.status.items())],
        rows=apart[:NAMES],
        tables=[
            Table(("error", "logs", "such as"), errors, "Logs without a result."),
            Table(HEADS, [_row(found, look) for look in looks], "All metrics."),
            Table(("column", "logs"), classes, "Other columns."),
        ],
        notes=[
            *([f"And {more} more stand apart: fleet.json has them."] if more > 0 else []),
            *(f"one recording, counted {len(g)} times: {', '.join(g)}" for g in found.copies),
            *([told] if (told := reach(found)) else []),
        ],
    )


def report(found: Summary, title: str) -> Facts:
    """The facts with a part for each metric: those first that drift or in which a log is apart."""
    filled = [look for look in found.looks if look.values.size]
    filled.sort(key=lambda look: (not look.drifts, not look.outlying.any()))
    told = [x for x in filled if x.drifts or x.outlying.any()]
    calm = [x for x in filled if not (x.drifts or x.outlying.any())]
    quiet = f"Metrics where nothing stands apart and nothing drifts: {len(calm)}"
    parts = [
        Facts("Metrics to look at", parts=[_metric(found, look) for look in told]),
        Facts(quiet, parts=[_metric(found, look) for look in calm], folded=True),
        Facts("How it was judged", notes=_judged(found)),
    ]
    return replace(facts(found, title), parts=parts)


def _metric(found: Summary, look: Look) -> Facts:
    caption = f"Distribution of {_name(look)}, and the logs in order."
    picture = Picture(caption, sheet(found, look))
    return Facts(f"{_name(look)} ({look.metric.name})", pictures=[picture])


def _judged(found: Summary) -> list[str]:
    by = found.ordered_by
    rules = "; ".join(f"{number}: {text}" for number, text in RULES.items())
    return [
        f"The line is in the order of {plain(by).name}. A log is named by all its metrics at a "
        f"share of false names of {100 * outliers.SHARE:.0f} %, and none below {outliers.FEWEST} "
        f"logs; {round(found.together)} of the metrics say new things. Of pages with good cars "
        "only, at most 8 % are expected to name one, or a drift. At most "
        f"{100 * DRIFT:.0f} % of the metrics drift by chance.",
        "In the pictures, dotted: one more log beyond it is named for this metric. Where a metric "
        "drifts, dashed: three sigma from log to log, and logs that break a Western Electric rule "
        f"({rules}) are marked: they show where to look and prove nothing.",
    ]


def reach(found: Summary) -> str:
    """How far from the others a log must be to be named, in words; "" if none can be judged."""
    ratios = [
        min(abs(edge - s.median) for edge in s.edges) / s.scale
        for look in found.looks
        if (s := look.spread).edges is not None and s.scale > plain(look.metric.name).step
    ]
    if not ratios:
        return ""
    middle = float(np.quantile(ratios, 0.5, method="nearest"))
    logs = counted(max(look.spread.count for look in found.looks), "log")
    if not np.isfinite(middle):
        return f"{logs} are too few to tell one apart in a typical metric, however far away it is."
    return (
        f"Among {logs} only one that is far away can be told apart: {middle:.1f} times the usual "
        "scatter (one sigma) from the median in a typical metric. One that is nearer may be odd, "
        "too: these logs cannot show it."
    )


def reason(found: Summary, o: Outlier) -> str:
    """One reason in words: `Pad friction, front 0.550: above the others, 90 % of them ...`."""
    look = next(look for look in found.looks if look.metric.name == o.metric)
    shown = _shown(look)
    low, high = map(shown, look.others)
    side = "above" if o.value > look.spread.median else "below"
    value = f"{plain(o.metric).name} {shown(o.value)}"
    return f"{value}: {side} the others, 90 % of them from {low} to {high}"


def _class(text: str) -> str:
    """A value of a text column; keys of metrics in it in plain names."""
    keys = [key.strip() for key in text.split(",")]
    return "; ".join(plain(key).name if key in METRICS else key for key in keys)


def _name(look: Look) -> str:
    return plain(look.metric.name, look.metric.unit).name


def _shown(look: Look) -> Callable[[float], str]:
    """The function that writes a value of a metric with its unit."""
    one = plain(look.metric.name, look.metric.unit)
    if one.step:
        return one.with_unit
    unit = f"{NBSP}{one.unit}" if one.unit else ""
    return lambda value: number(one.factor * value, look.spread) + unit


def _kind(found: Summary) -> str:
    """The verdict that sets the colour of the page's head."""
    calm = not (any(look.drifts for look in found.looks) or found.apart or found.failures)
    if _too_few(found) or (calm and not _drift_tested(found)):
        return UNJUDGED
    return PASSED if calm else WARNING


def _row(found: Summary, look: Look) -> tuple[str, ...]:
    """One metric: its scatter, beyond what a log is named, and where its level changes."""
    s, shown, c = look.spread, _shown(look), look.change
    low, high = map(shown, look.others)
    judged = bool(np.isfinite(s.z).any())
    drift = "not tested" if c is None else "no"
    if look.drifts and c is not None:
        place = f"{found.logs[look.rows[c.first]]}, number {look.rows[c.first] + 1}"
        drift = f"from {shown(c.before)} to {shown(c.after)} about {place} (p {c.p:.1e})"
    return (
        _name(look),
        str(s.count),
        shown(s.median),
        f"{low} to {high}",
        (in_words(s.edges, shown) if s.edges else "") or "no limit",
        str(int(look.outlying.sum())) if judged else "not judged",
        drift,
    )


def _by_chance(look: Look, rule: int) -> float | None:
    """How often a steady line would break ``rule``; None where there are too few logs to say."""
    n = look.values.size
    return BY_CHANCE[rule] * n if n >= FEWEST_BY_CHANCE else None


def number(value: float, about: MetricSpread) -> str:
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
        "copies": found.copies,
        "outliers": [
            {"log": o.log, "figure": o.metric, "value": o.value, "z": o.z, "p": o.p}
            for o in found.outliers
        ],
        "outliers_by_chance": outliers.SHARE * len(found.outliers),
        "apart": [
            {"log": car.log, "p": car.p, "figures": [o.metric for o in car.reasons]}
            for car in found.apart
        ],
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
        "named_beyond": s.edges,
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

"""The report of a fleet: one HTML file with pictures inside, and the same as a document.

Nothing in it is fetched. Every string that comes from a log or a file name is escaped.
"""

import base64
from collections.abc import Mapping, Sequence
from html import escape
from typing import Any

import numpy as np

from calib.fleet import control_chart, outliers, tails
from calib.fleet.control_chart import BY_CHANCE, FEWEST_BY_CHANCE, RULES
from calib.fleet.outliers import Spread
from calib.fleet.summary import DRIFT, Look, Shares, Summary
from calib.reports.html import page, paragraph, section, table

NAMES = 50
"""Outliers listed in the page; fleet.json has all."""


def headline(found: Summary) -> str:
    """The fleet in one sentence."""
    if _too_few(found):
        some = any(look.spread.count for look in found.looks)
        why = "too few to judge outliers or drift" if some else "none has a figure"
        said = f"{_count(len(found.logs), 'log', 'logs')}: {why}"
        return said + f"; {_errors(found)}." if found.failures else said + "."
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
    """Whether no figure has logs enough to be judged."""
    counts = [look.spread.count for look in found.looks]
    return max(counts, default=0) < min(outliers.FEWEST, control_chart.FEWEST)


def _drift_tested(found: Summary) -> bool:
    return any(look.change is not None for look in found.looks)


def report_html(found: Summary, title: str, pictures: Mapping[str, bytes]) -> str:
    """Return the page; ``pictures`` PNG by name of figure."""
    parts = [
        _head(found, title),
        _failures(found),
        _named(found),
        _overview(found),
        *(_figure(found, look, pictures[look.metric.name]) for look in _first(found)),
        _classes(found.shares),
        _method(found),
    ]
    return page(f"{title}: fleet", parts)


def _first(found: Summary) -> list[Look]:
    """Figures with something to tell before the quiet ones; those without a value not at all."""
    seen = [look for look in found.looks if look.values.size]
    return sorted(seen, key=lambda look: (not look.drifts, not look.outlying.any()))


def _head(found: Summary, title: str) -> str:
    kind = "no_gap" if _calm(found) else "ambiguous"
    if _too_few(found) or (_calm(found) and not _drift_tested(found)):
        kind = "unknown"
    shown = "".join(
        f"<div><dt>{escape(text)}</dt><dd>{value}</dd></div>"
        for text, value in (("logs", len(found.logs)), *found.status.items())
    )
    return (
        f'<header class="{kind}">\n<p class="kind">Fleet</p>\n'
        f"<h1>{escape(title)}</h1>\n"
        f'<p class="verdict">{escape(headline(found))}</p>\n<dl>{shown}</dl>\n</header>'
    )


def _calm(found: Summary) -> bool:
    return not (any(look.drifts for look in found.looks) or found.outliers or found.failures)


def _failures(found: Summary) -> str:
    if not found.failures:
        return ""
    rows = [(f.message, str(f.count), ", ".join(f.logs)) for f in found.failures]
    return section(
        "Errors",
        paragraph(
            "Logs without a result, by what was wrong. LOG and # stand for names and numbers."
        ),
        table("Errors by kind.", ("what was wrong", "logs", "such as"), rows),
    )


def _named(found: Summary) -> str:
    rows = [
        (o.log, o.metric, f"{o.value:.4g}", f"{o.z:+.1f}", f"{o.p:.1e}")
        for o in found.outliers[:NAMES]
    ]
    if not rows:
        return section(
            "Logs that stand apart",
            paragraph("Too few logs to tell." if _too_few(found) else "None."),
        )
    chance = outliers.SHARE * len(found.outliers)
    more = len(found.outliers) - len(rows)
    return section(
        "Logs that stand apart",
        paragraph(
            f"{_count(len(found.outliers), 'value is', 'values are')} named; about "
            f"{chance:.1f} of them by chance if the bulk of each figure is near normal."
            + (
                f" The farthest {NAMES} are listed, all {len(found.outliers)} in fleet.json."
                * (more > 0)
            )
        ),
        table("Farthest first.", ("log", "figure", "value", "robust z", "p"), rows),
    )


def _overview(found: Summary) -> str:
    rows = []
    for look in found.looks:
        s, unit = look.spread, look.metric.unit
        if not s.count:
            rows.append((look.metric.name, unit, "0", *("",) * 6))
            continue
        rows.append(
            (
                look.metric.name,
                unit,
                str(s.count),
                number(s.median, s),
                f"{s.scale:.2g}",
                f"{number(s.quantiles[0], s)} to {number(s.quantiles[3], s)}",
                f"{s.beyond} / {s.expected:.1f}" if np.isfinite(s.z).any() else "",
                str(int(look.outlying.sum())) if np.isfinite(s.z).any() else "not judged",
                _drift(look),
            )
        )
    heads = ("figure", "unit", "logs", "median", "scale", "5 to 95 %", "beyond 3 / by chance")
    return section(
        "All figures",
        table("Scale is 1.48 MAD.", (*heads, "outliers", "drift"), rows)
        if rows
        else paragraph("None."),
    )


def _drift(look: Look) -> str:
    if look.change is None:
        return "not tested"
    return f"{'yes' if look.drifts else 'no'}, p {look.change.p:.1e}"


def _figure(found: Summary, look: Look, picture: bytes) -> str:
    data = base64.b64encode(picture).decode()
    told = described(found, look)
    name = escape(look.metric.name)
    return section(
        look.metric.name,
        f'<figure><img src="data:image/png;base64,{data}" alt="{escape(told)}">'
        f"<figcaption>Distribution of {name}, and {name} in order.</figcaption></figure>",
        paragraph(told),
    )


def described(found: Summary, look: Look) -> str:
    """One figure in words: where it lies, whether it drifts, how many run rules it breaks."""
    s, unit = look.spread, "" if look.metric.unit == "1" else f" {look.metric.unit}"
    low, high = number(s.quantiles[0], s), number(s.quantiles[3], s)
    said = [f"Median {number(s.median, s)}{unit}, 90 % of the logs from {low} to {high}{unit}."]
    if look.drifts and look.change is not None:
        c = look.change
        said.append(
            f"The level changes from {number(c.before, s)} to {number(c.after, s)}{unit} about "
            f"{found.logs[look.rows[c.first]]}, number {look.rows[c.first] + 1} of the line "
            f"(p {c.p:.1e})."
        )
    if look.chart is not None:
        told = []
        for rule in RULES:
            broken, chance = int(look.chart.alarms[rule].sum()), _by_chance(look, rule)
            told.append(
                f"rule {rule}: {broken}" + ("" if chance is None else f" ({chance:.1f} by chance)")
            )
        said.append(f"Run rules broken: {'; '.join(told)}.")
    elif look.metric.name == found.ordered_by:
        said.append("The logs are ordered by it, so it has no control chart and cannot drift.")
    else:
        said.append("No control chart: too few logs, or no scatter.")
    return " ".join(said)


def _by_chance(look: Look, rule: int) -> float | None:
    """How often a steady line would break ``rule``; None where limits of so few logs err."""
    n = look.values.size
    return BY_CHANCE[rule] * n if n >= FEWEST_BY_CHANCE else None


def number(value: float, about: Spread) -> str:
    """``value`` with a digit more than the scatter of its figure has, at least four in all."""
    width = max(about.quantiles[3] - about.quantiles[0], 1e-300)
    digits = 4
    if value:
        digits = max(4, 3 + int(np.floor(np.log10(abs(value)) - np.log10(width))))
    return f"{value:.{min(digits, 10)}g}"


def _classes(shares: Sequence[Shares]) -> str:
    rows = [
        (s.metric.name, ", ".join(f"{text}: {count}" for text, count in s.counts)) for s in shares
    ]
    return section("Other columns", table("How often.", ("column", "logs"), rows)) if rows else ""


def _method(found: Summary) -> str:
    rules = "; ".join(f"{number}: {text}" for number, text in RULES.items())
    return section(
        "How it was judged",
        paragraph(f"The line is in the order of {found.ordered_by}."),
        paragraph(
            "A log stands apart by its robust z, (value less median)/(1.48 MAD), from "
            f"{tails.FEWEST} logs on of a plainly skewed or long-tailed figure after its bulk is "
            "straightened, held against a t law for a scale from so many logs, by the rule of "
            "Benjamini and Hochberg over all figures and logs: about "
            f"{100 * outliers.SHARE:.0f} % of those named are expected to be so by chance if the "
            f"bulk is near normal. Below {outliers.FEWEST} logs none is named. With fewer than "
            f"{tails.FEWEST} logs a skewed figure names good logs too, and one now and then with "
            "more; so does one with long tails up to some thousand logs, and one with two humps "
            "at any number. Compare how many lie beyond 3 with chance. A figure that is the same "
            "for half of the logs or more has no scale and names none."
        ),
        paragraph(
            "Drift is Pettitt's rank test for a change of level over the whole order, at most "
            f"{100 * DRIFT:.0f} % of the figures said to drift by chance. It is not made where "
            "so few logs could not show even a plain step in one of so many figures. The chart has "
            "its centre at the median and 3 sigma from the median moving range. Western Electric "
            f"rules: {rules}. They alarm on a steady line too, with known limits rule 1 once in "
            "370 logs, all four once in 92: they say where to look and prove nothing. Limits from "
            f"fewer than {FEWEST_BY_CHANCE} logs err too much for a count by chance. Logs of one "
            "line are taken as independent; runs of one car one after the other are not."
        ),
    )


def document(found: Summary) -> dict[str, Any]:
    """All of it as one JSON-able document."""
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

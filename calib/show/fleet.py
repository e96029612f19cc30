"""Facts of a fleet, and the picture of one metric in the order of the line.

Logs are points, over their median and the range of 90 %; where the level changes, both levels.
Logs that stand apart have their names; one that is beyond the axis is at its end.
"""

import textwrap
from collections.abc import Callable
from functools import partial
from pathlib import Path

import numpy as np

from calib.base.plain import NBSP, plain
from calib.line.fleet.summary import MetricSummary, Outlier, Summary
from calib.show.facts import PASSED, UNJUDGED, WARNING, Facts, Picture, Row, Table
from calib.show.numbers import number
from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet
from calib.show.style import BODY, IDENTIFIED, NOMINAL, REAR, Array, Stroke, as_text, dots

_FIRST = 5
"""Number of logs that stand apart in the head of the answer."""
_NAMES = 50
"""Number of logs that stand apart in the page; fleet.json has all."""
_HEADS = (*("metric", "logs", "median", "90 % of the logs", "stand apart", "drift"),)
_HALF_WIDTHS = {
    "front": "ecu_interval_f",
    "rear": "ecu_interval_r",
    "total": "ecu_interval_level",
}
"""Half widths of the 95 % interval of a torque over itself, by the part of the car."""
_ALONE = "none: it is a log of the fit, or run the command on it alone"
_THIN: Stroke = {"color": BODY["color"], "linewidth": 0.8}
_LEVEL: Stroke = {**IDENTIFIED, "linewidth": 2.0}
_LINE = 32
"""Letters of an axis' name that fit beside a panel."""
_NAMED, _LETTERS = 8, 9
"""Logs that are named: all of so few, else those that stand apart, the farthest first; and letters
in a line of a name below the axis."""
_TAIL, _FEWEST = 6.0, 10
"""Range of the axis about the median, in scales, of so many values."""


def fleet_facts(summary: Summary) -> Facts:
    """Facts of a fleet; the logs that stand apart come first."""
    looks = [look for look in summary.metrics if look.values.size]
    drawn = [x for x in summary.metrics if x.values.size and (x.drifts or x.outlying.any())]
    drawn.sort(key=lambda look: not look.drifts)
    apart = [
        (car.log, "; ".join(_reason(summary, o) for o in car.reasons)) for car in summary.apart
    ]
    errors = [(f.message, str(f.count), ", ".join(f.logs)) for f in summary.failures]
    failed = [(log, _limits(why)) for log, why in summary.failed.items()]
    more = f" and {len(failed) - _FIRST} more" if len(failed) > _FIRST else ""
    first: list[Row] = [("failed", ", ".join(log for log, _ in failed[:_FIRST]) + more)]
    return Facts(
        "Fleet",
        headline=summary.headline,
        verdict=_verdict(summary),
        numbers=[
            ("logs", str(len(summary.logs))),
            *((k, str(n)) for k, n in summary.status.items()),
        ],
        rows=[*_torque(looks), *(first if failed else []), *apart[:_FIRST]],
        notes=[f"one recording, counted {len(g)} times: {', '.join(g)}" for g in summary.copies],
        parts=[
            Facts("All that stands apart", rows=apart[:_NAMES] if len(apart) > _FIRST else ()),
            Facts(
                "Logs that failed, or are without a result",
                tables=[
                    Table(("log", "limits that it does not hold"), failed, "Failed."),
                    Table(("error", "logs", "such as"), errors, "Without a result."),
                ],
            ),
            Facts("All metrics", tables=[Table(_HEADS, [_row(summary, look) for look in looks])]),
            Facts("Metrics to look at", parts=[_metric(summary, look) for look in drawn]),
        ],
    )


def _torque(looks: list[MetricSummary]) -> list[Row]:
    """How well the ECU knows the torque, which is known as well as the pads: the median stop."""
    medians = {look.column.name: look.median for look in looks}
    halves = [
        f"{side} \N{PLUS-MINUS SIGN}{NBSP}{plain(name).with_unit(medians[name])}"
        for side, name in _HALF_WIDTHS.items()
        if name in medians
    ]
    return [("brake torque (95 %)", ", ".join(halves))] if halves else []


def _limits(keys: str) -> str:
    """Names of metrics, which a row joins by commas."""
    return ", ".join(plain(key.strip()).name for key in keys.split(",")) if keys else _ALONE


def _metric(summary: Summary, look: MetricSummary) -> Facts:
    picture = Picture(f"{look.name}, log by log.", partial(metric_sheet, summary, look))
    return Facts(f"{look.name} ({look.column.name})", pictures=[picture])


def _reason(summary: Summary, o: Outlier) -> str:
    """One reason in words: `Pad friction, front 0.550: above the others, 90 % of them ...`."""
    look = next(look for look in summary.metrics if look.column.name == o.figure)
    shown = _shown(look)
    low, high = map(shown, look.inlier_range)
    side = "above" if o.value > look.median else "below"
    value = f"{plain(o.figure).name} {shown(o.value)}"
    return f"{value}: {side} the others, 90 % of them from {low} to {high}"


def _shown(look: MetricSummary) -> Callable[[float], str]:
    """The function that writes a value of a metric with its unit."""
    metric = plain(look.column.name, look.column.unit)
    if metric.step:
        return metric.with_unit
    unit, quantiles = f"{NBSP}{metric.unit}" if metric.unit else "", look.quantiles
    step = 0.1 * metric.factor * (quantiles["95"] - quantiles["5"])
    return lambda value: number(metric.factor * value, step) + unit


def _verdict(summary: Summary) -> str:
    """The verdict that sets the colour of the page's head."""
    calm = not (any(look.drifts for look in summary.metrics) or summary.apart or summary.failures)
    judged = any(look.judged for look in summary.metrics)
    if not judged or (calm and not summary.drift_tested):
        return UNJUDGED
    return PASSED if calm else WARNING


def _row(summary: Summary, look: MetricSummary) -> tuple[str, ...]:
    """One metric: its scatter, the logs that stand apart, and where its level changes."""
    shown, c = _shown(look), look.change
    low, high = map(shown, look.inlier_range)
    drift = "not tested" if c is None else "no"
    if look.drifts and c is not None:
        place = f"{summary.logs[look.rows[c.first]]}, number {look.rows[c.first] + 1}"
        drift = f"from {shown(c.old_level)} to {shown(c.new_level)} about {place} (p {c.p:.1e})"
    return (
        look.name,
        str(look.values.size),
        shown(look.median),
        f"{low} to {high}",
        str(int(look.outlying.sum())) if look.judged else "not judged",
        drift,
    )


def metric_sheet(summary: Summary, look: MetricSummary) -> Sheet:
    """Return the sheet of one metric, in the unit that is shown."""
    shown = plain(look.column.name, look.column.unit)
    k, x, ends = shown.factor, np.asarray(look.rows + 1, float), window(look)
    y: Array = k * np.clip(look.values, *ends)
    few, whole = len(summary.logs) <= _NAMED, (0.0, len(summary.logs) + 1.0)
    share = "90 % of the others" if look.outlying.any() else "90 % of the logs"
    low, high = (np.full(2, k * end) for end in look.inlier_range)
    lines = [
        Line(x, y, dots(NOMINAL, 4.5, ".", alpha=1.0 if few else 0.5)),
        Line(whole, [k * look.median] * 2, _THIN, f"median, {share}", (low, high)),
    ]
    if look.drifts and (change := look.change) is not None:
        parts = (
            (x[: change.first], change.old_level, "level"),
            (x[change.first :], change.new_level, ""),
        )
        lines += [
            Line(outlying[[0, -1]], [k * level] * 2, _LEVEL, label)
            for outlying, level, label in parts
        ]
    if (outlying := look.outlying).any():
        lines.append(Line(x[outlying], y[outlying], dots(REAR, 5.0, "D", zorder=5), "stands apart"))
    names = [as_text(Path(log).stem) for log in summary.logs]
    away = np.argsort(-np.abs(look.values - look.median), kind="stable")
    farthest = [i for i in away if look.outlying[i]][:_NAMED]
    room = 0.06 * (ends[1] - ends[0])
    panel = Panel(
        "order",
        as_text(look.name),
        f"log, ordered by {as_text(summary.ordered_by)}",
        textwrap.fill(as_text(shown.heading), _LINE),
        lines,
        texts=[(names[look.rows[i]], x[i], y[i]) for i in farthest],
        xlim=whole,
        ylim=(k * (ends[0] - room), k * (ends[1] + room)),
        xticks=["", *(textwrap.fill(name, _LETTERS) for name in names)] if few else (),
        columns=2,
    )
    return Sheet("fleet", look.column.name, (panel,), heights=(1.3,))


def window(look: MetricSummary) -> tuple[float, float]:
    """Range of the axis: all values, but at most `_TAIL` scales from the median."""
    low, high = float(np.min(look.values)), float(np.max(look.values))
    if look.scale > 0.0 and look.values.size >= _FEWEST:
        reach = _TAIL * look.scale
        low, high = max(low, look.median - reach), min(high, look.median + reach)
    alike = high - low <= 1e-9 * max(abs(low), abs(high))
    return (low - 0.5, high + 0.5) if alike else (low, high)

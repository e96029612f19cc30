"""Facts of a fleet, the logs of many drives, and the picture of one metric, log by log.

An outlier is a log that stands apart from the others in one metric. A picture has a point for each
log, the median and the range of 90 % of the logs; a value beyond the axis is drawn at its end.
"""

import textwrap
from collections.abc import Callable
from pathlib import Path

import numpy as np

from calib.base.plain import NBSP, metric_of
from calib.line.fleet.summary import MetricSummary, Outlier, Summary
from calib.show.facts import PASSED, UNJUDGED, WARNING, Facts, Picture, Row, Table
from calib.show.numbers import number
from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet
from calib.show.style import BODY, NOMINAL, REAR, Array, Stroke, as_text, dots, names_below

_FIRST, _MOST = 5, 50
"""Largest number of outliers at the head of the page, and of outliers on the page."""
_HEADS = ("metric", "logs", "median", "90 % of the logs", "stand apart")
_HALF_WIDTHS = {"front": "ecu_interval_f", "rear": "ecu_interval_r", "total": "ecu_interval_level"}
"""Metrics that are the 95 % half width of a torque over the torque, by the part of the car."""
_ALONE = "none: it is a log of the fit, or run the command on it alone"
"""Text of a log that failed without a broken limit."""
_THIN: Stroke = {"color": BODY["color"], "linewidth": 0.8}


def fleet_facts(summary: Summary) -> Facts:
    """Return the facts of a fleet; the logs that failed or stand apart come first."""
    metrics = [metric for metric in summary.metrics if metric.values.size]
    apart = [
        (log, "; ".join(_reason(summary, outlier) for outlier in outliers))
        for log, outliers in summary.outliers.items()
    ]
    errors = [(x.message, str(x.count), ", ".join(x.logs)) for x in summary.failures]
    failed = [(log, _limit_names(keys)) for log, keys in summary.failed.items()]
    more = f" and {len(failed) - _FIRST} more" if len(failed) > _FIRST else ""
    first_failed = ", ".join(log for log, _ in failed[:_FIRST]) + more
    failed_row = [("failed", first_failed)] if failed else []
    copies = [f"one recording, counted {len(x)} times: {', '.join(x)}" for x in summary.copies]
    drawn = [_metric_part(summary, metric) for metric in metrics if metric.outlying.any()]
    verdict = WARNING if summary.outliers or summary.failures else PASSED
    return Facts(
        "Fleet",
        headline=summary.headline,
        verdict=verdict if summary.judged else UNJUDGED,
        numbers=[
            ("logs", str(len(summary.logs))),
            *((status, str(count)) for status, count in summary.status.items()),
        ],
        rows=[*_torque_row(metrics), *failed_row, *apart[:_FIRST]],
        notes=copies,
        parts=[
            Facts("All that stands apart", rows=apart[:_MOST] if len(apart) > _FIRST else ()),
            Facts(
                "Logs that failed, or are without a result",
                tables=[
                    Table(("log", "limits that it does not hold"), failed, "Failed."),
                    Table(("error", "logs", "such as"), errors, "Without a result."),
                ],
            ),
            Facts("All metrics", tables=[Table(_HEADS, list(map(_row, metrics)))]),
            Facts("Metrics to look at", parts=drawn),
        ],
    )


def _torque_row(metrics: list[MetricSummary]) -> list[Row]:
    """Return one row with the relative 95 % half widths of the ECU's torque in the median stop."""
    medians = {metric.column.name: metric.median for metric in metrics}
    halves = [
        f"{side} ±{NBSP}{metric_of(name).with_unit(medians[name])}"
        for side, name in _HALF_WIDTHS.items()
        if name in medians
    ]
    return [("brake torque (95 %)", ", ".join(halves))] if halves else []


def _limit_names(keys: str) -> str:
    """Return the names of metrics by their ``keys``, which commas separate."""
    return ", ".join(metric_of(key.strip()).name for key in keys.split(",")) if keys else _ALONE


def _metric_part(summary: Summary, metric: MetricSummary) -> Facts:
    picture = Picture(f"{metric.name}, log by log.", lambda: metric_sheet(summary, metric))
    return Facts(f"{metric.name} ({metric.column.name})", pictures=[picture])


def _reason(summary: Summary, outlier: Outlier) -> str:
    """Return why a log stands apart, such as `Pad friction, front 0.550: above the others, ...`."""
    metric = next(metric for metric in summary.metrics if metric.column.name == outlier.figure)
    text_of = _text_of(metric)
    low, high = map(text_of, metric.inlier_range)
    side = "above" if outlier.value > metric.median else "below"
    value = f"{metric_of(outlier.figure).name} {text_of(outlier.value)}"
    return f"{value}: {side} the others, 90 % of them from {low} to {high}"


def _text_of(metric: MetricSummary) -> Callable[[float], str]:
    """Return the function that writes a value of a metric with its unit."""
    printed = metric_of(metric.column.name, metric.column.unit)
    if printed.step:
        return printed.with_unit
    unit = f"{NBSP}{printed.unit}" if printed.unit else ""
    step = 0.1 * printed.factor * (metric.quantiles["95"] - metric.quantiles["5"])
    return lambda value: number(printed.factor * value, step) + unit


def _row(metric: MetricSummary) -> tuple[str, ...]:
    text_of = _text_of(metric)
    low, high = map(text_of, metric.inlier_range)
    return (
        metric.name,
        str(metric.values.size),
        text_of(metric.median),
        f"{low} to {high}",
        str(int(metric.outlying.sum())) if metric.judged else "not judged",
    )


def metric_sheet(summary: Summary, metric: MetricSummary) -> Sheet:
    """Return the sheet of one metric in its printed unit, with the names of the farthest logs."""
    printed = metric_of(metric.column.name, metric.column.unit)
    factor, ends, outlying = printed.factor, window(metric), metric.outlying
    x = np.asarray(metric.rows + 1, float)  # the first log of the fleet is at 1
    axis = 0.0, len(summary.logs) + 1.0
    y: Array = factor * np.clip(metric.values, *ends)
    share = "90 % of the others" if outlying.any() else "90 % of the logs"
    low, high = (np.full(2, factor * end) for end in metric.inlier_range)
    names = [Path(log).stem for log in summary.logs]
    below = names_below(names)
    lines = [
        Line(x, y, dots(NOMINAL, 4.5, ".", alpha=1.0 if below else 0.5)),
        Line(axis, [factor * metric.median] * 2, _THIN, f"median, {share}", (low, high)),
    ]
    if outlying.any():
        lines.append(Line(x[outlying], y[outlying], dots(REAR, 5.0, "D", zorder=5), "stands apart"))
    by_distance = np.argsort(-np.abs(metric.values - metric.median), kind="stable")
    farthest = [i for i in by_distance if outlying[i]][:8]  # more names would overlap
    room = 0.06 * (ends[1] - ends[0])
    panel = Panel(
        "order",
        as_text(metric.name),
        "log, in the order of the names",
        textwrap.fill(as_text(printed.heading), 32),  # letters that fit beside a panel
        lines,
        texts=[(as_text(names[metric.rows[i]]), x[i], y[i]) for i in farthest],
        xlim=axis,
        ylim=(factor * (ends[0] - room), factor * (ends[1] + room)),
        xticks=["", *below] if below else (),
        columns=2,
    )
    return Sheet("fleet", metric.column.name, (panel,), heights=(1.3,))


def window(metric: MetricSummary) -> tuple[float, float]:
    """Return the ends of an axis for the values of a metric, in their unit.

    The axis shows all values; of ten or more, those within 6 `MetricSummary.scale` of the median.
    """
    low, high = float(np.min(metric.values)), float(np.max(metric.values))
    if metric.scale > 0.0 and metric.values.size >= 10:
        tail = 6.0 * metric.scale
        low, high = max(low, metric.median - tail), min(high, metric.median + tail)
    are_equal = high - low <= 1e-9 * max(abs(low), abs(high))
    return (low - 0.5, high + 0.5) if are_equal else (low, high)

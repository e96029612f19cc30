"""One metric of a fleet in the order of the line.

Logs are points, over their median, the range of 90 % and the limits beyond which one more is named;
where the level changes, both levels, 3 sigma of a steady line and the alarms of the run rules. Logs
that stand apart have their names; one that is beyond the axis is at its end.
"""

import textwrap
from pathlib import Path

import numpy as np

from calib.base.plain import plain
from calib.line.fleet.control_chart import FEWEST
from calib.line.fleet.summary import Look, Summary, in_words
from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet
from calib.show.style import (
    BODY,
    DASHED,
    DOTTED,
    IDENTIFIED,
    NOMINAL,
    REAR,
    Array,
    Stroke,
    as_text,
)

_EDGE: Stroke = {"color": REAR["color"], "linestyle": DOTTED, "linewidth": 1.4}
_APART: Stroke = {"color": REAR["color"], "marker": "D", "linestyle": "", "ms": 5.0, "zorder": 5}
_DOT: Stroke = {"color": NOMINAL["color"], "marker": ".", "linestyle": "", "ms": 4.5}
_NONE: Stroke = {"color": NOMINAL["color"], "marker": "x", "linestyle": "", "ms": 4.0}
_THIN: Stroke = {"color": BODY["color"], "linewidth": 0.8}

_DOTS = 2000
"""Above this number of cars the points are drawn as a raster image, not as vectors."""

_LINE = 32
"""Letters of an axis' name that fit beside a panel."""

_NAMED, _LETTERS = 8, 9
"""Logs that are named: all of so few, else those that stand apart, the farthest first; and letters
in a line of a name below the axis."""

TAIL, WIDEST = 6.0, 20.0
"""Range of the axes about the median, in scales; it grows to the second one where the limits beyond
which a log is named are wider."""


def sheet(found: Summary, look: Look) -> Sheet:
    """Return the sheet of one metric, in the unit that is shown: the individuals chart."""
    return Sheet("fleet", look.metric.name, (_in_order(found, look),), heights=(1.3,))


def _in_order(found: Summary, look: Look) -> Panel:
    k, x, ends = _factor(look), np.asarray(look.rows + 1, float), _room(look)
    y: Array = k * np.clip(look.values, *window(look))
    whole, few = np.array([0.0, len(found.logs) + 1.0]), len(found.logs) <= _NAMED
    names = ["", *(textwrap.fill(_stem(log), _LETTERS) for log in found.logs)]
    share = "90 % of the others" if look.outlying.any() else "90 % of the logs"
    low, high = (np.full(2, k * end) for end in look.others)
    middle = [k * look.spread.median] * 2
    lines = [
        Line(x, y, {**_DOT, "alpha": 1.0 if few else 0.5, "rasterized": x.size > _DOTS}),
        Line(whole, middle, _THIN, f"median, {share}", (low, high)),
        *(_level(whole, edge, _EDGE, label) for edge, label in _edges(look)),
    ]
    if look.chart is not None and look.drifts:
        for end, label in zip(look.chart.limits, ("3 sigma of a steady line", ""), strict=True):
            lines.append(_level(whole, k * end, {**_THIN, "linestyle": DASHED}, label))
        alarm = np.logical_or.reduce([*look.chart.alarms.values()])
        label = "run rule broken" if alarm.any() else ""
        lines.append(Line(x[alarm], y[alarm], {**_DOT, "color": "#E69F00"}, label))
    if look.drifts and (change := look.change) is not None:
        stroke: Stroke = {**IDENTIFIED, "linewidth": 2.0}
        lines.append(_level(x[: change.first], k * change.before, stroke, "level"))
        lines.append(_level(x[change.first :], k * change.after, stroke))
    without = np.setdiff1d(np.arange(1.0, len(found.logs) + 1.0), x)
    if without.size:
        lines.append(
            Line(without, np.full(without.size, 0.98 * ends[0] + 0.02 * ends[1]), _NONE, "no value")
        )
    at = look.outlying
    if at.any():
        lines.append(Line(x[at], y[at], _APART, "stands apart"))
    return Panel(
        "order",
        as_text(look.name),
        f"log, ordered by {as_text(found.ordered_by)}",
        textwrap.fill(_axis(look), _LINE),
        lines,
        texts=[(_stem(found.logs[look.rows[i]]), x[i], y[i]) for i in _farthest(look)],
        xlim=(whole[0], whole[1]),
        ylim=ends,
        xticks=names if few else (),
        columns=2,
    )


def _farthest(look: Look) -> list[int]:
    """The values that stand apart and are named."""
    away = np.abs(look.values - look.spread.median)
    order = np.argsort(-away, kind="stable")
    return [int(i) for i in order if look.outlying[i]][:_NAMED]


def _stem(log: str) -> str:
    return as_text(Path(log).stem)


def _level(x: Array, value: float, look: Stroke, label: str = "") -> Line:
    return Line([x[0], x[-1]], [value, value], look, label)


def _edges(look: Look) -> list[tuple[float, str]]:
    """Limits beyond which a log is named, where in view, as shown; the first with its label."""
    k, (low, high) = _factor(look), window(look)
    edges = [edge for edge in look.spread.edges or () if low <= edge <= high]
    places = int(np.clip(2 - np.floor(np.log10(k * (high - low))), 0, 10))
    told = in_words(look.spread.edges or (np.nan, np.nan), lambda x: f"{k * x:.{places}f}")
    return [(k * edge, "" if i else f"apart {told}") for i, edge in enumerate(edges)]


def window(look: Look) -> tuple[float, float]:
    """Range of the axes: all values, but at most `TAIL` scales from the median, and the limits."""
    low, high = float(np.min(look.values)), float(np.max(look.values))
    reach = TAIL * look.spread.scale
    if look.chart is not None:
        reach = max(reach, 3.5 * look.chart.sigma)
    if reach > 0.0 and look.values.size >= FEWEST:
        low, high = max(low, look.spread.median - reach), min(high, look.spread.median + reach)
    for edge in look.spread.edges or ():
        away = edge - look.spread.median
        if abs(away) <= WIDEST * look.spread.scale:  # a mark beyond the limit has room, too
            low, high = min(low, edge + 0.1 * away), max(high, edge + 0.1 * away)
    alike = high - low <= 1e-9 * max(abs(low), abs(high))
    return (low - 0.5, high + 0.5) if alike else (low, high)


def _room(look: Look) -> tuple[float, float]:
    k, (low, high) = _factor(look), window(look)
    return k * (low - 0.06 * (high - low)), k * (high + 0.06 * (high - low))


def _factor(look: Look) -> float:
    return plain(look.metric.name).factor


def _axis(look: Look) -> str:
    return as_text(plain(look.metric.name, look.metric.unit).heading)

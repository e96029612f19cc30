"""One metric of a fleet: its distribution, and its values in the order of the line.

distribution   cars as steps, median, 5 to 95 %, the limits beyond which a car is named
in order       cars as points, the same limits; where the level changes, both levels, 3 sigma of a
               steady line and the alarms of the run rules

Cars that stand apart are marked; one that is beyond an axis is at its end.
"""

import textwrap

import numpy as np

from calib.base.plain import plain
from calib.line.fleet.control_chart import FEWEST
from calib.line.fleet.summary import Look, Summary, in_words
from calib.show.sheet import Line, Mark, Panel, Sheet
from calib.show.style import (
    BODY,
    DASHED,
    DOTTED,
    FRONT,
    IDENTIFIED,
    NOMINAL,
    REAR,
    SHADE,
    Array,
    Stroke,
    as_text,
)

_EDGE: Stroke = {"color": REAR["color"], "linestyle": DOTTED, "linewidth": 1.4}
_APART: Stroke = {"color": REAR["color"], "marker": "D", "linestyle": "", "ms": 5.0, "zorder": 5}
_DOT: Stroke = {"color": NOMINAL["color"], "marker": ".", "linestyle": "", "ms": 4.0}
_STEPS: Stroke = {"color": "#56B4E9", "drawstyle": "steps-post"}
_THIN: Stroke = {"color": BODY["color"], "linewidth": 0.8}

_DOTS = 2000
"""Above this number of cars the points are drawn as a raster image, not as vectors."""

_LINE = 32
"""Letters of an axis' name that fit beside a panel."""

TAIL, WIDEST = 6.0, 20.0
"""Range of the axes about the median, in scales; it grows to the second one where the limits beyond
which a log is named are wider."""


def sheet(found: Summary, look: Look) -> Sheet:
    """Return the sheet of one metric, in the unit that is shown."""
    panels = (_distribution(look), _in_order(found, look))
    return Sheet("fleet", look.metric.name, panels, (("distribution", "order", "order"),), (1.05,))


def _distribution(look: Look) -> Panel:
    k, (low, high) = _factor(look), window(look)
    inside = look.values[(look.values >= low) & (look.values <= high)]
    bins = int(np.clip(2.0 * np.sqrt(inside.size), 5, 60))
    counts, edges = np.histogram(inside, bins, (low, high))
    share = "90 % of the others" if look.outlying.any() else "90 % of the logs"
    marks = [
        Mark(k * look.others[0], k * look.others[1], {"color": SHADE}, share),
        Mark(k * look.spread.median, k * look.spread.median, FRONT, "median"),
        *(Mark(edge, edge, _EDGE, label) for edge, label in _edges(look)),
    ]
    lines = [Line(k * edges, [*counts, counts[-1]], _STEPS)]
    lines += _apart(look, k * np.clip(look.values, low, high), np.zeros(look.values.size))
    axis = textwrap.fill(_axis(look), 2 * _LINE)
    ends = _room(look)
    return Panel("distribution", "Distribution", axis, "logs", lines, marks, xlim=ends, columns=2)


def _in_order(found: Summary, look: Look) -> Panel:
    """The individuals chart along the line."""
    k, x = _factor(look), np.asarray(look.rows + 1, float)
    y = np.clip(look.values, *window(look))
    lines = [Line(x, k * y, {**_DOT, "alpha": 0.5, "rasterized": x.size > _DOTS})]
    if look.chart is not None:
        lines.append(_level(x, k * look.chart.centre, _THIN, "median"))
    lines += [_level(x, edge, _EDGE, label) for edge, label in _edges(look)]
    if look.chart is not None and look.drifts:
        for end, label in zip(look.chart.limits, ("3 sigma of a steady line", ""), strict=True):
            lines.append(_level(x, k * end, {**_THIN, "linestyle": DASHED}, label))
        alarm = np.logical_or.reduce([*look.chart.alarms.values()])
        label = "run rule broken" if alarm.any() else ""
        lines.append(Line(x[alarm], k * y[alarm], {**_DOT, "color": "#E69F00"}, label))
    if look.drifts and (change := look.change) is not None:
        stroke: Stroke = {**IDENTIFIED, "linewidth": 2.0}
        lines.append(_level(x[: change.first], k * change.before, stroke, "level"))
        lines.append(_level(x[change.first :], k * change.after, stroke))
    lines += _apart(look, x, k * y)
    return Panel(
        "order",
        "In the order of the line",
        f"log, ordered by {as_text(found.ordered_by)}",
        textwrap.fill(_axis(look), _LINE),
        lines,
        xlim=(0.0, len(found.logs) + 1.0),
        ylim=_room(look),
        columns=2,
    )


def _level(x: Array, value: float, look: Stroke, label: str = "") -> Line:
    return Line([x[0], x[-1]], [value, value], look, label)


def _apart(look: Look, x: Array, y: Array) -> list[Line]:
    """Marks at ``x``, ``y`` (n,) of the logs that stand apart."""
    at = look.outlying
    return [Line(x[at], y[at], _APART, "stands apart")] if at.any() else []


def _edges(look: Look) -> list[tuple[float, str]]:
    """Limits beyond which a log is named, where in view, as shown; the first with its label."""
    k, (low, high) = _factor(look), window(look)
    edges = [edge for edge in look.spread.edges or () if low <= edge <= high]
    places = int(np.clip(2 - np.floor(np.log10(k * (high - low))), 0, 10))
    told = in_words(look.spread.edges or (np.nan, np.nan), lambda x: f"{k * x:.{places}f}")
    return [(k * edge, "" if i else f"named {told}") for i, edge in enumerate(edges)]


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

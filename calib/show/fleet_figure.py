"""One metric of a fleet in the order of the line.

Logs are points, over their median and the range of 90 %; where the level changes, both levels. Logs
that stand apart have their names; one that is beyond the axis is at its end.
"""

import textwrap
from pathlib import Path

import numpy as np

from calib.base.plain import plain
from calib.line.fleet.drift import LevelChange
from calib.line.fleet.summary import Look, Summary
from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet
from calib.show.style import BODY, IDENTIFIED, NOMINAL, REAR, Array, Stroke, as_text, dots

_APART, _DOT = dots(REAR, 5.0, "D", zorder=5), dots(NOMINAL, 4.5, ".")
_THIN: Stroke = {"color": BODY["color"], "linewidth": 0.8}
_LEVEL: Stroke = {**IDENTIFIED, "linewidth": 2.0}

_LINE = 32
"""Letters of an axis' name that fit beside a panel."""
_NAMED, _LETTERS = 8, 9
"""Logs that are named: all of so few, else those that stand apart, the farthest first; and letters
in a line of a name below the axis."""
_TAIL, _FEWEST = 6.0, 10
"""Range of the axis about the median, in scales, of so many values."""


def sheet(found: Summary, look: Look) -> Sheet:
    """Return the sheet of one metric, in the unit that is shown: the individuals chart."""
    return Sheet("fleet", look.metric.name, (_in_order(found, look),), heights=(1.3,))


def _in_order(found: Summary, look: Look) -> Panel:
    shown = plain(look.metric.name, look.metric.unit)
    k, x, ends = shown.factor, np.asarray(look.rows + 1, float), window(look)
    y: Array = k * np.clip(look.values, *ends)
    few, whole = len(found.logs) <= _NAMED, (0.0, len(found.logs) + 1.0)
    share = "90 % of the others" if look.outlying.any() else "90 % of the logs"
    low, high = (np.full(2, k * end) for end in look.others)
    lines = [
        Line(x, y, {**_DOT, "alpha": 1.0 if few else 0.5}),
        Line(whole, [k * look.spread.median] * 2, _THIN, f"median, {share}", (low, high)),
        *(_levels(look.change, k, x) if look.change and look.drifts else ()),
    ]
    if (at := look.outlying).any():
        lines.append(Line(x[at], y[at], _APART, "stands apart"))
    room = 0.06 * (ends[1] - ends[0])
    return Panel(
        "order",
        as_text(look.name),
        f"log, ordered by {as_text(found.ordered_by)}",
        textwrap.fill(as_text(shown.heading), _LINE),
        lines,
        texts=[(_stem(found.logs[look.rows[i]]), x[i], y[i]) for i in _farthest(look)],
        xlim=whole,
        ylim=(k * (ends[0] - room), k * (ends[1] + room)),
        xticks=["", *(textwrap.fill(_stem(log), _LETTERS) for log in found.logs)] if few else (),
        columns=2,
    )


def _levels(change: LevelChange, k: float, x: Array) -> list[Line]:
    """The levels on both sides of a change."""
    before, after = x[[0, change.first - 1]], x[[change.first, -1]]
    return [
        Line(before, [k * change.before] * 2, _LEVEL, "level"),
        Line(after, [k * change.after] * 2, _LEVEL),
    ]


def _farthest(look: Look) -> list[int]:
    """The values that stand apart and are named."""
    away = np.abs(look.values - look.spread.median)
    order = np.argsort(-away, kind="stable")
    return [int(i) for i in order if look.outlying[i]][:_NAMED]


def _stem(log: str) -> str:
    return as_text(Path(log).stem)


def window(look: Look) -> tuple[float, float]:
    """Range of the axis: all values, but at most `_TAIL` scales from the median."""
    low, high = float(np.min(look.values)), float(np.max(look.values))
    spread = look.spread
    if spread.scale > 0.0 and look.values.size >= _FEWEST:
        reach = _TAIL * spread.scale
        low, high = max(low, spread.median - reach), min(high, spread.median + reach)
    alike = high - low <= 1e-9 * max(abs(low), abs(high))
    return (low - 0.5, high + 0.5) if alike else (low, high)

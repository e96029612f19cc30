"""One metric of a fleet: its distribution, and its values in the order of the line.

distribution   bars of cars, median, 5 to 95 %, the limits beyond which a car is named, outliers as
               marks below, beyond the axis as arrows
in order       cars as points, centre and the same limits; where the level changes, both levels,
               3 sigma of a steady line and the alarms of the run rules
"""

import json
import re
import textwrap
from collections.abc import Callable, Iterator
from dataclasses import replace
from pathlib import Path

import numpy as np

from calib.base.plain import plain
from calib.line.fleet.control_chart import FEWEST, RULES
from calib.line.fleet.summary import Look, Summary, in_words
from calib.show.sheet import Panel, Sheet, render
from calib.show.style import (
    BODY,
    DASHED,
    DOTTED,
    FRONT,
    IDENTIFIED,
    NOMINAL,
    REAR,
    SHADE,
    Axes,
    Mask,
    Stroke,
)

_EDGE: Stroke = {"color": REAR["color"], "linestyle": DOTTED, "linewidth": 1.4}

_DOTS = 2000
"""Above this number of cars the points are drawn as a raster image, not as vectors."""

_LIMITS = "3 sigma of a steady line"

_LINE = 32
"""Letters of an axis' name that fit beside a panel."""

TAIL, WIDEST = 6.0, 20.0
"""Range of the axes about the median, in scales; a value beyond is a mark at the edge. It grows to
the second one where the limits beyond which a log is named are wider."""
DOCUMENT = "fleet.json"
"""The document of a report, beside its pictures."""


def sheet(found: Summary, look: Look) -> Sheet:
    """Return the sheet of one metric, in the unit that is shown."""
    look = _in_unit(look)
    return Sheet(
        kind="fleet",
        name=look.metric.name,
        title="",
        note="",
        panels=(
            Panel("distribution", "Distribution", distribution, (look,), 2),
            Panel("order", "In the order of the line", in_order, (found, look), 2),
        ),
        rows=(("distribution", "order", "order"),),
        heights=(1.05,),
    )


def distribution(ax: Axes, look: Look) -> None:
    """Draw bars of the bulk, median and quantiles, and outliers as marks on the axis."""
    low, high = window(look)
    inside = look.values[(look.values >= low) & (look.values <= high)]
    bins = int(np.clip(2.0 * np.sqrt(inside.size), 5, 60))
    ax.hist(inside, bins=bins, range=(low, high), color="#8DB9DA", linewidth=0.0)
    share = "90 % of the others" if look.outlying.any() else "90 % of the logs"
    ax.axvspan(*look.others, color=SHADE, linewidth=0.0, zorder=0, label=share)
    ax.axvline(look.spread.median, color=FRONT["color"], label="median")
    for edge, label in _edges(look, low, high):
        ax.axvline(edge, label=label, **_EDGE)
    for part, marker, label in _outliers(look, low, high, "<>"):
        # x in axes coordinates and not clipped: marks at the edge for values beyond it
        far = np.clip(look.values[part], low, high)
        marks = ax.plot(far, np.full(far.size, 0.02), marker, color=REAR["color"], ms=5)[0]
        marks.set(transform=ax.get_xaxis_transform(), clip_on=False, zorder=5, label=label)
    ax.set_xlim(*_room(low, high))
    ax.locator_params(axis="x", nbins=4)
    ax.locator_params(axis="y", integer=True)
    ax.set(xlabel=textwrap.fill(_axis(look), 2 * _LINE), ylabel="logs")


def in_order(ax: Axes, found: Summary, look: Look) -> None:
    """Draw the individuals chart along the line."""
    low, high = window(look)
    x, y = look.rows + 1, np.clip(look.values, low, high)
    many = x.size > _DOTS
    ax.plot(x, y, ".", color=NOMINAL["color"], ms=2.0 if many else 4.0, alpha=0.5, rasterized=many)
    if look.chart is not None:
        ax.axhline(look.chart.centre, color=BODY["color"], linewidth=0.8, label="median")
    for edge, label in _edges(look, low, high):
        ax.axhline(edge, label=label, **_EDGE)
    if look.chart is not None and look.drifts:
        shown = [end for end in look.chart.limits if low <= end <= high]
        for end, label in zip(shown, (_LIMITS, None), strict=False):
            ax.axhline(end, color=BODY["color"], linestyle=DASHED, linewidth=0.8, label=label)
        alarm = np.logical_or.reduce([look.chart.alarms[rule] for rule in RULES])
        if alarm.any():
            label = "run rule broken"
            ax.plot(x[alarm], y[alarm], ".", color="#E69F00", ms=3.0 if many else 5.0, label=label)
    if look.drifts and look.change is not None:
        k, c = look.change.first, look.change
        for logs, level, label in ((x[:k], c.before, "level"), (x[k:], c.after, None)):
            ends = [logs[0], logs[-1]]
            ax.plot(ends, [level, level], color=IDENTIFIED["color"], linewidth=2.0, label=label)
    for part, marker, label in _outliers(look, low, high, "v^"):
        ax.plot(x[part], y[part], marker, color=REAR["color"], ms=5, label=label)
    ax.set_ylim(*_room(low, high))
    ax.set_xlim(0.0, len(found.logs) + 1.0)
    ax.locator_params(axis="x", integer=True)
    ordered_by = found.ordered_by.replace("$", r"\$")
    ax.set(xlabel=f"log, ordered by {ordered_by}", ylabel=textwrap.fill(_axis(look), _LINE))


def _outliers(look: Look, low: float, high: float, arrows: str) -> Iterator[tuple[Mask, str, str]]:
    """Outliers within the axes, then those below and above: mask, mark and label of each group."""
    below, above = look.values < low, look.values > high
    groups = (
        (~below & ~above, "D", "stands apart"),
        (below, arrows[0], ""),
        (above, arrows[1], ""),
    )
    for where, marker, label in groups:
        part = look.outlying & where
        values = np.unique(look.values[part])
        if values.size:
            ends = f"{values[0]:.4g}" + (f" to {values[-1]:.4g}" if values.size > 1 else "")
            yield part, marker, label or f"stands apart: {ends}"


def _edges(look: Look, low: float, high: float) -> Iterator[tuple[float, str | None]]:
    """Limits beyond which a log is named, NaN if outside of the axes; the first with its label."""
    finite = [edge for edge in look.spread.edges or () if np.isfinite(edge)]
    places = int(np.clip(2 - np.floor(np.log10(high - low)), 0, 10))
    told = f"named {in_words(look.spread.edges or (np.nan, np.nan), lambda x: f'{x:.{places}f}')}"
    seen = [edge if low <= edge <= high else np.nan for edge in finite]
    if not np.isfinite(seen).any():
        told += " (not in view)"
    yield from zip(seen, (told, None), strict=False)


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


def _room(low: float, high: float) -> tuple[float, float]:
    return low - 0.06 * (high - low), high + 0.06 * (high - low)


def _in_unit(look: Look) -> Look:
    """The metric with all numbers in the unit that is shown."""
    k, s, chart, c = plain(look.metric.name).factor, look.spread, look.chart, look.change
    if k == 1.0:
        return look
    q = (k * s.quantiles[0], k * s.quantiles[1], k * s.quantiles[2], k * s.quantiles[3])
    edges = s.edges and (k * s.edges[0], k * s.edges[1])
    return replace(
        look,
        values=k * look.values,
        spread=replace(s, median=k * s.median, scale=k * s.scale, quantiles=q, edges=edges),
        chart=chart and replace(chart, centre=k * chart.centre, sigma=k * chart.sigma),
        change=c and replace(c, before=k * c.before, after=k * c.after),
    )


def _axis(look: Look) -> str:
    heading = plain(look.metric.name, look.metric.unit).heading
    return heading.replace("$", r"\$")  # a dollar in a name must not start a formula


def picture_name(figure: str) -> str:
    """File name of the picture of a metric; valid for any column name."""
    return re.sub(r"[^\w.-]", "_", figure) + ".png"


def pictures_of(found: Summary, step: Callable[[], None]) -> dict[str, bytes]:
    """A PNG of each metric with values, by its file name."""
    pictures = {}
    for look in (look for look in found.looks if look.values.size):
        pictures[picture_name(look.metric.name)] = render(sheet(found, look).overview(), ".png")
        step()
    return pictures


def earlier_pictures(out: Path) -> set[str]:
    """File names of the pictures of an earlier report in ``out``."""
    try:
        figures = json.loads((out / DOCUMENT).read_text(encoding="utf-8"))["figures"]
        return {picture_name(name) for name in figures}
    except (OSError, ValueError, TypeError, KeyError):
        return set()

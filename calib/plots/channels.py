"""All columns of a log over one time axis, with the events marked.

Columns of one kind and unit, such as the four wheel speeds, share a panel. A long log is drawn by
the lowest and the highest value of each of `BINS` parts, so that no peak is lost.
"""

from typing import TYPE_CHECKING

import numpy as np
from numpy.typing import NDArray

from calib.checks.events import BITE, BRAKING, LEAD_IN, STANDSTILL, RunEvent
from calib.logs.whole import TIME, WholeColumn, WholeLog
from calib.names import CHANNELS, WHEELS
from calib.plots import log
from calib.plots.stop import WHEEL_STROKES
from calib.plots.style import BODY, FRONT, REAR, WIDTH, Stroke, styled

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

Array = NDArray[np.float64]

BINS = 2000
"""Parts of a long log; a page has some 1000 pixels."""
PANEL = 1.05
"""Height of a panel [in]."""
MOST = 40
"""Panels of one picture; more are not readable."""

SPANS: dict[str, Stroke] = {
    LEAD_IN: {"facecolor": log.LEAD_IN},
    BRAKING: {"facecolor": log.BRAKING},
    STANDSTILL: {"facecolor": "#F8E6D8"},
}
"""Colour of the spans; their names are above the first panel."""


def panels_of(whole: WholeLog) -> dict[str, tuple[WholeColumn, ...]]:
    """The columns by panel, in the order of the log; the clock has none."""
    found: dict[str, tuple[WholeColumn, ...]] = {}
    for column in whole.columns:
        if column.name != TIME:
            key = f"{_kind(column.name)} [{column.unit or '?'}]"
            found[key] = (*found.get(key, ()), column)
    return found


def _kind(name: str) -> str:
    """``omega`` of omega_fl, ``T_disc`` of T_disc_f; a foreign name is its own kind."""
    stem, _, last = name.rpartition("_")
    shared = last in (*WHEELS, "f", "r") and (name in CHANNELS or name.startswith("true_"))
    return stem if shared else name


def figure(whole: WholeLog, events: tuple[RunEvent, ...] = ()) -> "Figure":
    """Draw a log. Raises ValueError for one without columns or with more than `MOST` panels."""
    from matplotlib.figure import Figure

    panels = panels_of(whole)
    if not 0 < len(panels) <= MOST:
        raise ValueError(f"{len(panels)} panels, at most {MOST} can be drawn")
    time = whole.time
    with styled():
        made = Figure(figsize=(WIDTH, PANEL * len(panels) + 1.1), layout="constrained")
        axes = made.subplots(len(panels), sharex=True, squeeze=False)[:, 0]
        for ax, (title, columns) in zip(axes, panels.items(), strict=True):
            _draw(ax, time, title, columns)
            _mark(ax, events)
        axes[-1].set_xlabel("time [s]")
        axes[-1].set_xlim(time[0], time[-1])
        made.suptitle(f"Log {whole.name}", x=0.012, ha="left")
        _legend(made, events)
    return made


def _draw(ax: "Axes", time: Array, title: str, columns: tuple[WholeColumn, ...]) -> None:
    for column in columns:
        ax.plot(*envelope(time, column.values), label=column.name, **_stroke(column.name, columns))
    ax.set_title(title, fontsize=8.0, pad=3.0)
    if len(columns) > 1:
        ax.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=len(columns))
    if not any(np.isfinite(column.values).any() for column in columns):
        ax.text(0.5, 0.5, "no value", transform=ax.transAxes, ha="center", va="center")


def _stroke(name: str, columns: tuple[WholeColumn, ...]) -> Stroke:
    if len(columns) == 1:
        return {**BODY, "linewidth": 0.8}
    last = name.rpartition("_")[2]
    known = {**WHEEL_STROKES, "f": FRONT, "r": REAR}
    return {**known.get(last, BODY), "linewidth": 0.8}


def envelope(time: Array, values: Array) -> tuple[Array, Array]:
    """Times and values to draw: all, or lowest and highest of each of `BINS` parts."""
    if values.size <= 4 * BINS:
        return time, values
    edges = np.linspace(0, values.size, BINS + 1).astype(np.intp)
    at = np.repeat(time[edges[:-1]], 2)
    none = np.isnan(values)
    low, high = np.where(none, np.inf, values), np.where(none, -np.inf, values)
    ends = [np.minimum.reduceat(low, edges[:-1]), np.maximum.reduceat(high, edges[:-1])]
    drawn = np.ravel(ends, order="F")
    return at, np.where(np.isfinite(drawn), drawn, np.nan)


def _mark(ax: "Axes", events: tuple[RunEvent, ...]) -> None:
    for event in events:
        if event.kind == BITE:
            ax.axvline(event.start, color="#B3471B", linewidth=0.9, linestyle=(0, (3, 2)))
        else:
            ax.axvspan(event.start, event.end, zorder=0, lw=0.0, **SPANS[event.kind])


def _legend(made: "Figure", events: tuple[RunEvent, ...]) -> None:
    from matplotlib.lines import Line2D
    from matplotlib.patches import Patch

    kinds = dict.fromkeys(event.kind for event in events)
    marks = [
        Line2D([], [], color="#B3471B", linewidth=0.9, linestyle=(0, (3, 2)), label=kind)
        if kind == BITE
        else Patch(label=kind, **SPANS[kind])
        for kind in kinds
    ]
    if marks:
        made.legend(
            handles=marks,
            loc="upper right",
            ncols=len(marks),
            bbox_to_anchor=(0.99, 1.0),
            borderaxespad=0.9,  # at the height of the title
        )

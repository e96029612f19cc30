"""The plots of a station report: curves of the table, pads by stop, each stop over time."""

from typing import TYPE_CHECKING

import numpy as np

from calib.plots.sheet import Panel, Sheet
from calib.plots.style import FRONT, REAR, band, shade, smooth, view
from calib.plots.table import sheet as table_sheet
from calib.table.table import Table
from calib.validation.validate import Validation

if TYPE_CHECKING:
    from matplotlib.axes import Axes

TAKEN = ("f1-f2", "difference", "budget")
"""Panels of the table's own sheet."""

MOST = 5
"""Samples between two points of a drawn line: 25 ms at 200 Hz, less than the window of its mean."""


def sheet(table: Table, results: tuple[Validation, ...]) -> Sheet:
    """Panels of the table, `pads`, and `stop-1`, `stop-2` ... for the hold-outs."""
    of_table = table_sheet(table, "").panels
    curves = tuple(panel for panel in of_table if panel.name in TAKEN)
    pads = Panel("pads", "Pads by stop", lambda ax: pads_by_stop(ax, table, results), 2)
    stops = tuple(
        Panel(f"stop-{i}", _plain(r.log), lambda ax, r=r: pads_over_time(ax, r), 2)  # type: ignore[misc]
        for i, r in enumerate(results, 1)
    )
    panels = (*curves, pads, *stops)
    return Sheet("station", "station", "", "", panels, tuple((p.name,) for p in panels))


def pads_by_stop(ax: "Axes", table: Table, results: tuple[Validation, ...]) -> None:
    """Mean pad friction of each hold-out with its median 95 % interval, and the table's."""
    cal = table.calibration
    for axle, stroke, of_table, shift in (
        ("f", FRONT, cal.pad_friction_f, -0.08),
        ("r", REAR, cal.pad_friction_r, 0.08),
    ):
        word = "front" if axle == "f" else "rear"
        low, high = of_table.ci95
        ax.axhspan(low, high, color=stroke["color"], alpha=0.18, lw=0.0)
        ax.axhline(of_table.value, **stroke, linewidth=0.9, label=f"{word}, table")
        known = [
            (i + shift, mu, mu * width)
            for i, r in enumerate(results, 1)
            if (mu := r.figures[f"pad_friction_{axle}"]) is not None
            and (width := r.figures[f"interval_{axle}"]) is not None
        ]
        if known:
            x, y, half = np.asarray(known).T
            marker = "o" if axle == "f" else "s"
            ax.errorbar(x, y, half, fmt=marker, color=stroke["color"], ms=4, label=f"{word}, stop")
    ax.set_xlim(0.5, len(results) + 0.5)
    ax.set_xticks(range(1, len(results) + 1))
    ax.set_xlabel("stop, in the order of the table below")
    ax.set_ylabel("pad friction [1]")


def pads_over_time(ax: "Axes", result: Validation) -> None:
    """Pad friction of both axles over time with its 95 % band where it is valid; else grey."""
    e = result.estimate
    shade(ax, e.time, ~e.valid)
    curves = []
    for axle, stroke, word in ((e.front, FRONT, "front"), (e.rear, REAR, "rear")):
        good = np.where(e.valid, axle.pad_friction, np.nan)
        lower, upper = (np.where(e.valid, x, np.nan) for x in (axle.lower, axle.upper))
        line, low, high = (x[::MOST] for x in (smooth(e.time, good), lower, upper))
        band(ax, e.time[::MOST], low, high, stroke)
        ax.plot(e.time[::MOST], line, label=word, **stroke)
        curves += [line, low, high]
    view(ax, *curves, zero=True)
    ax.set_xlabel("time [s]")
    ax.set_ylabel("pad friction [1]")


def _plain(name: str) -> str:
    """A log's name as plain text: no formula, and only characters that the font has."""
    return "".join(c if c.isascii() and c.isprintable() else "?" for c in name).replace("$", r"\$")

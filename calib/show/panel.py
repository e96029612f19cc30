"""A panel: what one pair of axes shows.

    Line   values over an axis, with their 95 % band
    Mark   a part of the axis, over the whole height
    Panel  lines, marks and texts

The legend of a panel is between its title and its axes, where it covers no data.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from calib.show.style import Array, Axes, Stroke, envelope, pale, reach, smooth

_POINTS = 72.0
"""Points to the inch."""
RAW = 0.3
"""Opacity of measured values behind their mean."""
PARTS = 2000
"""Parts of the `envelope` of a long line: a page has some 1000 pixels."""


@dataclass(frozen=True)
class Line:
    """``y`` over ``x`` (n,) with its ``band``; of noisy values also the mean over ``mean`` [s]."""

    x: Array | Sequence[float]
    y: Array | Sequence[float]
    look: Stroke
    label: str = ""
    band: tuple[Array, Array] | None = None
    mean: float = 0.0

    @property
    def shown(self) -> Array:
        """The values of the thick line (n,)."""
        y = np.asarray(self.y, float)
        return smooth(np.asarray(self.x), y, self.mean) if self.mean else y

    def fill(self, ax: Axes, parts: int) -> None:
        """Draw the line; of a long one the `envelope` in so many ``parts``."""
        x, colour = np.asarray(self.x, float), self.look["color"]
        if self.mean:
            y = np.asarray(self.y, float)
            points = envelope(y, parts)
            ax.plot(x[points], y[points], color=colour, linewidth=0.5, alpha=RAW)
        points = envelope(self.shown, parts)
        ax.plot(x[points], self.shown[points], label=self.label, **self.look)

    def fill_band(self, ax: Axes, parts: int) -> None:
        """Draw the band, opaque and pale, with its edges."""
        if self.band is None:
            return
        x, (low, high) = np.asarray(self.x, float), (np.asarray(end, float) for end in self.band)
        points, colour = envelope(low, parts), self.look["color"]
        fill: Stroke = {"fc": pale(colour), "ec": (colour, 0.7), "lw": 0.6, "zorder": 1}
        ax.fill_between(x[points], low[points], high[points], **fill)


@dataclass(frozen=True)
class Mark:
    """The part of the x axis from ``start`` to ``end``; an upright line where they are equal."""

    start: float
    end: float
    look: Stroke
    label: str = ""

    def fill(self, ax: Axes) -> None:
        """Draw it behind the lines."""
        if self.start == self.end:
            ax.axvline(self.start, label=self.label, zorder=1, **self.look)
        else:
            ax.axvspan(self.start, self.end, label=self.label, lw=0.0, zorder=0, **self.look)


@dataclass(frozen=True)
class Field:
    """Values (rows, columns) as colours over the whole of a panel, NaN where none is known.

    The title of the panel names them. ``ends`` of its axes: left, right, bottom, top; ``middle`` of
    a scale that has one. ``slices`` the values at equal steps of one axis more, which only a
    browser can show; ``slider`` its name and both ends.
    ``torques`` of the front and the rear axle [N m] at a height of 1 if it brakes alone, and the
    odds of front over rear where the value is 1; () for a field that has none.
    """

    values: Array
    ends: tuple[float, float, float, float]
    middle: float | None = None
    slices: Sequence[Array] = ()
    slider: tuple[str, float, float] | None = None
    torques: tuple[float, ...] = ()

    @property
    def scale(self) -> tuple[str, float, float]:
        """Name of the colours in matplotlib, and the values of the first and the last one."""
        low, high = np.nanquantile(self.values, [0.02, 0.98])
        if self.middle is None:
            return "viridis_r", low, high
        far = max(high - self.middle, self.middle - low)
        return "RdBu_r", self.middle - far, self.middle + far

    def fill(self, ax: Axes) -> None:
        """Draw it with its scale beside the axes; a picture in an SVG, too."""
        from matplotlib.ticker import MaxNLocator

        cmap, low, high = self.scale
        look: Stroke = {"aspect": "auto", "origin": "lower", "interpolation": "none", "zorder": 0}
        image = ax.imshow(self.values, cmap, vmin=low, vmax=high, extent=self.ends, **look)
        ticks = MaxNLocator(6)  # as many in every height, so that they keep their width
        room = ax.inset_axes((1.02, 0.0, 0.035, 1.0))
        scale = ax.figure.colorbar(image, cax=room, ticks=ticks, extend="both")
        if scale.solids is not None:
            scale.solids.set(rasterized=True)


@dataclass(frozen=True)
class Panel:
    """One pair of axes.

    Attributes
    ----------
    name, title : for ``--figure``, and above the axes.
    x, y : what is on the axes, with units.
    lines, marks : as they are drawn, the last on top.
    texts : words, each beside a point of the axes.
    xlim, ylim : ends of the axes. ``ylim`` None: those of zero and of the means of the lines.
    xticks, yticks : words at 0, 1, 2 ... instead of numbers.
    columns : entries in a row of the legend.
    field : colours behind all, between ``xlim`` and ``ylim``.
    """

    name: str
    title: str
    x: str
    y: str
    lines: Sequence[Line]
    marks: Sequence[Mark] = ()
    texts: Sequence[tuple[str, float, float]] = ()
    xlim: tuple[float, float] | None = None
    ylim: tuple[float, float] | None = None
    xticks: Sequence[str] = ()
    yticks: Sequence[str] = ()
    columns: int = 3
    field: Field | None = None

    def fill(self, ax: Axes, parts: int = PARTS) -> float:
        """Draw the panel, long lines in so many ``parts``; return the height of the legend [pt]."""
        if self.field is not None:
            self.field.fill(ax)
        for line in self.lines:
            line.fill(ax, parts)
        for line in reversed(self.lines):
            line.fill_band(ax, parts)
        for mark in self.marks:
            mark.fill(ax)
        for text, *point in self.texts:
            is_left = self.xlim is not None and point[0] > np.mean(self.xlim)  # there is room
            shift: dict[str, Any] = {"xytext": (-4.0 if is_left else 4.0, -9.5), "fontsize": 7.0}
            side = "right" if is_left else "left"
            ax.annotate(text, (point[0], point[1]), textcoords="offset points", ha=side, **shift)
        ax.set(xlabel=self.x, ylabel=self.y)
        for limit, set_to in ((self.xlim, ax.set_xlim), (self.height, ax.set_ylim)):
            if limit is not None:
                set_to(*limit)
        if self.xticks:
            ax.set_xticks(range(len(self.xticks)), self.xticks)
        if self.yticks:
            ax.set_yticks(range(len(self.yticks)), self.yticks)
        if not ax.get_legend_handles_labels()[1]:
            return 0.0
        legend = ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=self.columns)
        return _POINTS * legend.get_window_extent().height / legend.figure.dpi

    def shares(self, other: "Panel") -> bool:
        """Whether both have the same x axis, which is then labelled once."""
        return self.xlim is not None and (self.x, self.xlim) == (other.x, other.xlim)

    @property
    def height(self) -> tuple[float, float] | None:
        """Ends of the y axis; None where nothing sets them."""
        if self.ylim is not None:
            return self.ylim
        return reach(*(line.shown for line in self.lines if line.mean), zero=True)

"""A panel: what one pair of axes shows, and how matplotlib draws it.

    Line   values over the x axis, with their 95 % band
    Mark   a part of the x axis, over the whole height
    Field  values as colours over the whole panel
    Panel  lines, marks, texts and a field

The legend of a panel is between its title and its axes, where it covers no data. The module
`calib.show.interactive` draws the same panels in a browser.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from calib.show.style import Array, Axes, Stroke, axis_ends, envelope, pale, smooth

_POINTS = 72.0
"""Points to the inch."""
RAW = 0.3
"""Opacity of measured values behind their mean."""
PARTS = 2000
"""Parts of the `envelope` of a long line; a printed page is about 1,000 pixels wide."""


@dataclass(frozen=True)
class Line:
    """A line through ``y`` over ``x``, (n,) each.

    Attributes
    ----------
    look : colour, width, dashes and marker.
    label : name in the legend, "" for none.
    band : lower and upper bounds (n,) of the values.
    mean : window [s] of the mean that is drawn as the line, with ``y`` pale behind it; 0 for none.
    """

    x: Array | Sequence[float]
    y: Array | Sequence[float]
    look: Stroke
    label: str = ""
    band: tuple[Array, Array] | None = None
    mean: float = 0.0

    @property
    def shown(self) -> Array:
        """Values of the thick line (n,): the mean, or ``y`` without one."""
        y = np.asarray(self.y, float)
        return smooth(np.asarray(self.x), y, self.mean) if self.mean else y

    def draw(self, ax: Axes, parts: int) -> None:
        """Draw the line without its band; of a long line the `envelope` in so many ``parts``."""
        x, colour = np.asarray(self.x, float), self.look["color"]
        if self.mean:
            y = np.asarray(self.y, float)
            points = envelope(y, parts)
            ax.plot(x[points], y[points], color=colour, linewidth=0.5, alpha=RAW)
        points = envelope(self.shown, parts)
        ax.plot(x[points], self.shown[points], label=self.label, **self.look)

    def draw_band(self, ax: Axes, parts: int) -> None:
        """Draw the band in a pale colour, with its edges."""
        if self.band is None:
            return
        x, low, high = (np.asarray(values, float) for values in (self.x, *self.band))
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

    def draw(self, ax: Axes) -> None:
        """Draw the mark behind the lines."""
        if self.start == self.end:
            ax.axvline(self.start, label=self.label, zorder=1, **self.look)
        else:
            ax.axvspan(self.start, self.end, label=self.label, lw=0.0, zorder=0, **self.look)


@dataclass(frozen=True)
class Field:
    """Values as colours over the whole panel, whose title names the values.

    A third axis, which only a browser can show, has a slider.

    Attributes
    ----------
    values : shape (rows, columns), the lowest row first; NaN where the value is not known.
    ends : left, right, lower and upper end of the axes.
    middle : value in the middle of the colours; None for a scale from the lowest to the highest.
    slices : the values at equal steps of the third axis.
    slider : name and both ends of the third axis.
    torques : numbers by which a cursor on the map of a table tells brake torques; () for none. At
        y = 1: torque of the front axle if it brakes alone, the same of the rear axle [N m], and
        front over rear torque where the value is 1 [1].
    """

    values: Array
    ends: tuple[float, float, float, float]
    middle: float | None = None
    slices: Sequence[Array] = ()
    slider: tuple[str, float, float] | None = None
    torques: tuple[float, ...] = ()

    @property
    def scale(self) -> tuple[str, float, float]:
        """Name of the colours in matplotlib, and the values of the first and the last colour."""
        low, high = np.nanquantile(self.values, [0.02, 0.98])  # a few outliers keep the end colour
        if self.middle is None:
            return "viridis_r", low, high
        half = max(high - self.middle, self.middle - low)
        return "RdBu_r", self.middle - half, self.middle + half

    def draw(self, ax: Axes) -> None:
        """Draw the field, with its scale beside the axes; in an SVG both are pixels."""
        from matplotlib.ticker import MaxNLocator

        cmap, low, high = self.scale
        look: Stroke = {"aspect": "auto", "origin": "lower", "interpolation": "none", "zorder": 0}
        image = ax.imshow(self.values, cmap, vmin=low, vmax=high, extent=self.ends, **look)
        ticks = MaxNLocator(6)  # their number, and so their width, is the same at every height
        scale_axes = ax.inset_axes((1.02, 0.0, 0.035, 1.0))
        scale = ax.figure.colorbar(image, cax=scale_axes, ticks=ticks, extend="both")
        if scale.solids is not None:
            scale.solids.set(rasterized=True)


@dataclass(frozen=True)
class Panel:
    """One pair of axes.

    Attributes
    ----------
    name : name of the panel, which ``--figure`` takes.
    title : text above the axes.
    x, y : labels of the axes, with units.
    lines : lines in the order of drawing: the last line is on top, and the first band.
    marks : parts of the x axis, behind the lines.
    texts : words, and x and y of the point that they stand beside.
    xlim, ylim : ends of the axes; None for all that is drawn. Where lines have means, the y axis
        then shows zero and the means.
    xticks, yticks : words at 0, 1, 2 ... instead of numbers.
    columns : number of entries in a row of the legend.
    field : colours behind everything, between ``xlim`` and ``ylim``.
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

    def draw(self, ax: Axes, parts: int = PARTS) -> float:
        """Draw the panel without its title; return the height of the legend [pt]."""
        if self.field is not None:
            self.field.draw(ax)
        for line in self.lines:
            line.draw(ax, parts)
        for line in reversed(self.lines):
            line.draw_band(ax, parts)
        for mark in self.marks:
            mark.draw(ax)
        for text, x, y in self.texts:
            # a text is on the left of a point in the right half of the axis
            is_left = self.xlim is not None and x > np.mean(self.xlim)
            side, shift = ("right", -4.0) if is_left else ("left", 4.0)
            place: dict[str, Any] = {"xytext": (shift, -9.5), "textcoords": "offset points"}
            ax.annotate(text, (x, y), ha=side, fontsize=7.0, **place)
        ax.set(xlabel=self.x, ylabel=self.y)
        for ends, set_ends in ((self.xlim, ax.set_xlim), (self.y_ends, ax.set_ylim)):
            if ends is not None:
                set_ends(*ends)
        if self.xticks:
            ax.set_xticks(range(len(self.xticks)), self.xticks)
        if self.yticks:
            ax.set_yticks(range(len(self.yticks)), self.yticks)
        if not ax.get_legend_handles_labels()[1]:
            return 0.0
        legend = ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=self.columns)
        return _POINTS * legend.get_window_extent().height / legend.figure.dpi

    def shares_x(self, other: "Panel") -> bool:
        """Whether this panel and the ``other`` panel have the same x axis."""
        return self.xlim is not None and (self.x, self.xlim) == (other.x, other.xlim)

    @property
    def y_ends(self) -> tuple[float, float] | None:
        """Ends of the y axis; None for all that is drawn."""
        means = [line.shown for line in self.lines if line.mean]
        return self.ylim or axis_ends(*means, with_zero=True)

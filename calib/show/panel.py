"""A panel: what one pair of axes shows, and how matplotlib draws it.

    Line   values over the x axis, with a band around them
    Mark   a marked range of the x axis, over the whole height of the panel
    Field  values as colours over the whole panel
    Panel  lines, marks, texts and a field

`calib.show.interactive` draws the same panels in a browser. In this room, the ``look`` of a line
names its colour, width, dashes and marker as matplotlib does.
"""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from calib.show.style import Array, Axes, Stroke, axis_ends, envelope, pale, smooth

RAW = 0.3
"""Opacity of the values behind their mean [1]."""
PARTS = 2000
"""Parts of the `envelope` of a long line; a printed page is about 1,000 pixels wide."""


@dataclass(frozen=True)
class Line:
    """A line through ``y`` over ``x``, (n,) each.

    If ``mean`` is not 0, the line is a mean over time, with ``y`` pale behind it.
    """

    x: Array | Sequence[float]
    y: Array | Sequence[float]
    look: Stroke
    label: str = ""  # name in the legend, "" for none
    band: tuple[Array, Array] | None = None  # lower and upper bounds (n,)
    mean: float = 0.0  # window of the mean [s]

    @property
    def line_values(self) -> Array:
        """Values of the line (n,): the mean of ``y``, or ``y`` itself."""
        y = np.asarray(self.y, float)
        return smooth(np.asarray(self.x), y, self.mean) if self.mean else y

    def draw(self, ax: Axes, parts: int) -> None:
        """Draw the `envelope` of the line in ``parts``, without the band."""
        x, values = np.asarray(self.x, float), self.line_values
        if self.mean:
            y = np.asarray(self.y, float)
            points = envelope(y, parts)
            ax.plot(x[points], y[points], color=self.look["color"], linewidth=0.5, alpha=RAW)
        points = envelope(values, parts)
        ax.plot(x[points], values[points], label=self.label, **self.look)

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
    """The x axis from ``start`` to ``end``, or an upright line where these are equal."""

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
    """Values as colours over the whole panel; the title of the panel names the values.

    A third axis, which only a browser can show, has a slider. On the map of a table a browser also
    tells the brake torques of the axles, from three ``torques``: those of the front and of the rear
    axle if that axle alone brakes the car by 1 g [N m], and front over rear brake force where the
    value of the field is 1 [1].
    """

    values: Array  # (rows, columns), the lowest row first; NaN if not known
    ends: tuple[float, float, float, float]  # left, right, lower and upper end of the axes
    middle: float | None = None  # value of the middle colour; None for colours from low to high
    slices: Sequence[Array] = ()  # like ``values``, at equal steps of the third axis
    slider: tuple[str, float, float] | None = None  # name and both ends of the third axis
    torques: tuple[float, ...] = ()  # () for a field that is no such map

    @property
    def scale(self) -> tuple[str, float, float]:
        """Name of the colours in matplotlib, and the values of the first and the last colour."""
        low, high = np.nanquantile(self.values, [0.02, 0.98])  # outliers get the end colours
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
        ticks = MaxNLocator(6)  # at every height of the panel the same ticks, and so one width
        scale_axes = ax.inset_axes((1.02, 0.0, 0.035, 1.0))
        scale = ax.figure.colorbar(image, cax=scale_axes, ticks=ticks, extend="both")
        if scale.solids is not None:
            scale.solids.set(rasterized=True)


@dataclass(frozen=True)
class Panel:
    """One pair of axes."""

    name: str  # as --figure takes it
    title: str
    x: str  # label with unit
    y: str
    lines: Sequence[Line]  # on top are the last line, and the band of the first line
    marks: Sequence[Mark] = ()
    texts: Sequence[tuple[str, float, float]] = ()  # with x and y of the point beside the text
    xlim: tuple[float, float] | None = None  # ends of the axis, None for all that is drawn
    ylim: tuple[float, float] | None = None  # None for those that `y_ends` chooses
    xticks: Sequence[str] = ()  # words at 0, 1, 2 ... instead of numbers
    yticks: Sequence[str] = ()
    columns: int = 3  # number of entries in a row of the legend
    field: Field | None = None  # colours behind everything

    def draw(self, ax: Axes, parts: int = PARTS) -> float:
        """Draw the panel without its title; return the height of the legend above the axes [pt]."""
        if self.field is not None:
            self.field.draw(ax)
        for line in self.lines:
            line.draw(ax, parts)
        for line in reversed(self.lines):
            line.draw_band(ax, parts)
        for mark in self.marks:
            mark.draw(ax)
        for text, x, y in self.texts:
            alignment, shift = ("right", -4.0) if self.is_in_right_half(x) else ("left", 4.0)
            place: dict[str, Any] = {"xytext": (shift, -9.5), "textcoords": "offset points"}
            ax.annotate(text, (x, y), ha=alignment, fontsize=7.0, **place)
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
        return 72.0 * legend.get_window_extent().height / legend.figure.dpi  # 72 points to the inch

    def is_in_right_half(self, x: float) -> bool:
        """Whether ``x`` is in the right half of the axis, where a text goes left of its point."""
        return self.xlim is not None and x > 0.5 * (self.xlim[0] + self.xlim[1])

    def shares_x(self, other: "Panel") -> bool:
        """Whether this panel and the ``other`` panel have the same x axis."""
        return self.xlim is not None and (self.x, self.xlim) == (other.x, other.xlim)

    @property
    def y_ends(self) -> tuple[float, float] | None:
        """Ends of the y axis: ``ylim``, else those that show 0 and all means; None for no mean."""
        means = [line.line_values for line in self.lines if line.mean]
        return self.ylim or axis_ends(*means, with_zero=True)

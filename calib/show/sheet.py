"""A sheet: panels of one page, drawn together or one by one.

    Line   values over an axis, with their 95 % band
    Mark   a part of the axis, over the whole height
    Panel  lines, marks and texts in one pair of axes
    Sheet  panels, and the rows in which the page shows them

The legend of a panel is between its title and its axes, where it covers no data.
"""

import io
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from string import ascii_letters
from typing import Any

import numpy as np

from calib.base.write import write_whole
from calib.show.style import (
    HEIGHT,
    WIDTH,
    Array,
    Axes,
    Figure,
    Mask,
    Stroke,
    envelope,
    reach,
    smooth,
    styled,
)

_POINTS = 72.0
"""Points to the inch."""
_LETTER = 0.086
"""Width of a letter of the title [in], with a little to spare."""
BAND = 0.18
"""Opacity of a 95 % band."""
RAW = 0.3
"""Opacity of measured values behind their mean."""
_PARTS = 2000
"""Parts of a long line: a page has some 1000 pixels."""


@dataclass(frozen=True)
class Line:
    """``y`` over ``x`` (n,), and the two ends of its ``band``.

    Over measured values their mean over ``mean`` [s] is drawn, 0 for none. ``by`` (n,) is the
    deceleration of each point [g]: a slider marks it on the line, where a page has one.
    """

    x: Array | Sequence[float]
    y: Array | Sequence[float]
    look: Stroke
    label: str = ""
    band: tuple[Array, Array] | None = None
    mean: float = 0.0
    by: Array | None = None

    @property
    def shown(self) -> Array:
        """The values of the thick line (n,)."""
        y = np.asarray(self.y, float)
        return smooth(np.asarray(self.x), y, self.mean) if self.mean else y

    def fill(self, ax: Axes, parts: int) -> None:
        """Draw it; of a long one the lowest and the highest value of each of its ``parts``."""
        x, colour = np.asarray(self.x, float), self.look["color"]
        if self.band is not None:
            low, high = (np.asarray(end, float) for end in self.band)
            at = envelope(low, parts)
            ax.fill_between(x[at], low[at], high[at], color=colour, alpha=BAND, lw=0.0, zorder=1)
            for end in (low, high):  # where two bands overlap their ends tell them apart
                ax.plot(x[at], end[at], color=colour, linewidth=0.5, alpha=0.6, zorder=1)
        if self.mean:
            y = np.asarray(self.y, float)
            at = envelope(y, parts)
            ax.plot(x[at], y[at], color=colour, linewidth=0.5, alpha=RAW)
        at = envelope(self.shown, parts)
        ax.plot(x[at], self.shown[at], label=self.label, **self.look)


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
            ax.axvline(self.start, label=self.label, **self.look)
        else:
            ax.axvspan(self.start, self.end, label=self.label, lw=0.0, zorder=0, **self.look)


@dataclass(frozen=True)
class Panel:
    """One pair of axes.

    Attributes
    ----------
    name, title : for ``--figure``, and above the axes.
    x, y : what is on the axes, with units.
    lines, marks : as they are drawn, the last on top.
    texts : words, each beside a point of the axes.
    xlim, ylim : ends of the axes. Without ``ylim`` measured lines set it, by their means and zero,
        ``where`` it is true (n,).
    xticks : words at 0, 1, 2 ... instead of numbers.
    columns : entries in a row of the legend.
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
    where: Mask | None = None
    xticks: Sequence[str] = ()
    columns: int = 3

    def fill(self, ax: Axes, parts: int = _PARTS) -> float:
        """Draw the panel and its legend; returns the height of the legend [pt].

        Of a long line the lowest and the highest value of each of its ``parts`` are drawn.
        """
        for mark in self.marks:
            mark.fill(ax)
        for line in self.lines:
            line.fill(ax, parts)
        for text, *at in self.texts:
            left = self.xlim is not None and at[0] > np.mean(self.xlim)  # there is room
            shift: dict[str, Any] = {"xytext": (-4.0 if left else 4.0, -9.5), "fontsize": 7.0}
            side = "right" if left else "left"
            ax.annotate(text, (at[0], at[1]), textcoords="offset points", ha=side, **shift)
        ax.set(xlabel=self.x, ylabel=self.y)
        for limit, set_to in ((self.xlim, ax.set_xlim), (self.height, ax.set_ylim)):
            if limit is not None:
                set_to(*limit)
        if self.xticks:
            ax.set_xticks(range(len(self.xticks)), self.xticks)
        if not ax.get_legend_handles_labels()[1]:
            return 0.0
        legend = ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=self.columns)
        return _POINTS * legend.get_window_extent().height / legend.figure.dpi

    def shares(self, other: "Panel") -> bool:
        """Whether both have the same x axis, so that it need not be told twice."""
        return self.xlim is not None and (self.x, self.xlim) == (other.x, other.xlim)

    @property
    def height(self) -> tuple[float, float] | None:
        """Ends of the y axis; None where nothing sets them."""
        if self.ylim is not None:
            return self.ylim
        use = slice(None) if self.where is None else self.where
        return reach(*(line.shown[use] for line in self.lines if line.mean), zero=True)


@dataclass(frozen=True)
class Sheet:
    """The panels of one page.

    Attributes
    ----------
    kind : what is drawn: table, stop, simulation, comparison, log and so on.
    name : used in file names.
    panels : all panels; those that ``rows`` does not name are drawn only alone.
    rows : panel names in the layout of the page; a repeated name spans its places. Without any each
        panel has a row.
    heights : relative heights of the rows, or one for all.
    title, note : text above the panels and below them.
    result : what came out, in a line below the title.
    """

    kind: str
    name: str
    panels: tuple[Panel, ...]
    rows: tuple[tuple[str, ...], ...] = ()
    heights: tuple[float, ...] = (1.0,)
    title: str = ""
    note: str = ""
    result: str = ""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the panels."""
        return tuple(panel.name for panel in self.panels)

    @property
    def laid_out(self) -> tuple[str, ...]:
        """Names of the panels of the page, in its order."""
        return tuple(dict.fromkeys(name for row in self.rows for name in row)) or self.names

    def overview(self) -> Figure:
        """The page: A4 wide and 2.5 in for each row, at most A4 high."""
        from matplotlib.figure import Figure

        rows = self.rows or tuple((name,) for name in self.names)
        heights = self.heights if len(self.heights) == len(rows) else self.heights * len(rows)
        panels = {panel.name: panel for panel in self.panels}
        above = {
            up
            for upper, lower in pairwise(rows)
            for up, down in zip(upper, lower, strict=True)
            if upper.count(up) == lower.count(down) and panels[up].shares(panels[down])
        }
        with styled():
            height = min(2.5 * sum(heights) + 0.8, HEIGHT)
            figure = Figure(figsize=(WIDTH, height), layout="constrained")
            places = figure.subplot_mosaic([list(r) for r in rows], height_ratios=heights)
            legends = {n: panels[n].fill(ax) for n, ax in places.items()}
            top = {n: next(i for i, row in enumerate(rows) if n in row) for n in places}
            for i, (name, ax) in enumerate(places.items()):
                # titles of one row are at one height
                room = max(legends[n] for n in places if top[n] == top[name])
                letter = f"({ascii_letters[i]}) " * (len(places) > 1)
                ax.set_title(letter + panels[name].title, pad=4.0 + room)
                if name in above:
                    ax.set_xlabel("")
                    ax.tick_params(labelbottom=False)
            _frame(figure, self, 150)
        return figure

    def figure(
        self, name: str, size: tuple[float, float] = (0.85 * WIDTH, 4.4), parts: int = _PARTS
    ) -> Figure:
        """One panel on its own, of a ``size`` [in], with ``parts`` of a long line.

        Raises KeyError for a name that the sheet does not have.
        """
        from matplotlib.figure import Figure

        panel = {panel.name: panel for panel in self.panels}[name]
        with styled():
            figure = Figure(figsize=size, layout="constrained")
            ax = figure.subplots()
            ax.set_title(panel.title, pad=4.0 + panel.fill(ax, parts))
            _frame(figure, self, 125)
        return figure


def rows_of(names: Sequence[str], columns: int) -> tuple[tuple[str, ...], ...]:
    """Panels side by side in so many ``columns``; the last one fills its row.

    >>> rows_of(["a", "b", "c"], 2)
    (('a', 'b'), ('c', 'c'))
    """
    filled = [*names, *[names[-1]] * (-len(names) % columns)]
    return tuple(tuple(filled[i : i + columns]) for i in range(0, len(filled), columns))


def _frame(figure: Figure, sheet: Sheet, width: int) -> None:
    """Title above and note below, both from the left edge."""
    lines = (sheet.title, *textwrap.wrap(sheet.result, int(figure.get_figwidth() / _LETTER)))
    figure.suptitle("\n".join(lines), x=0.012, ha="left")
    if sheet.note:
        whole = sheet.note.replace(" %", "\u00a0%")  # no line break between a number and its unit
        text = "\n".join(textwrap.wrap(whole, width))
        figure.supxlabel(text, x=0.012, ha="left", fontsize=7.0, color="#444444")


# No time and no version of matplotlib in a file: they would change the bytes.
_METADATA: dict[str, dict[str, Any]] = {
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": "brake-cal"},
    ".pdf": {"CreationDate": None, "Producer": "brake-cal", "Creator": "brake-cal"},
}
"""Metadata of a file by ending; the keys are the endings that are known."""

ENDINGS = tuple(_METADATA)


_BEGINS = (b"\x89PNG", b"<?xml", b"%PDF")
"""First bytes of a file by each ending."""


def is_picture(data: bytes) -> bool:
    """Whether the bytes of a file are those of a picture as it is written here."""
    return data.startswith(_BEGINS)


def render(figure: Figure, ending: str, text: bool = False) -> bytes:
    """Bytes of one figure as ``.png``, ``.svg`` or ``.pdf``. Raises KeyError for another ending.

    An SVG whose letters are ``text``, not outlines, is half as large, in the font of the reader.
    """
    with styled(outlines=not text):
        buffer = io.BytesIO()
        figure.savefig(buffer, format=ending[1:], metadata=_METADATA[ending])
        return buffer.getvalue()


def save(pages: dict[Path, list[Figure]], done: Callable[[], None] = lambda: None) -> None:
    """Write each file with its pages; all are drawn before the first is written.

    ``done`` is called after each page is drawn. A file other than a PDF takes one page. Raises
    KeyError for an unknown ending, ValueError for too many pages, OSError if a file cannot be
    written.
    """
    from matplotlib.backends.backend_pdf import PdfPages

    ready = {}
    for path, figures in pages.items():
        ending, buffer = path.suffix.lower(), io.BytesIO()
        if ending == ".pdf":
            with styled(), PdfPages(buffer, metadata=_METADATA[ending]) as book:
                for figure in figures:
                    figure.savefig(book, format="pdf")
                    done()
            ready[path] = buffer.getvalue()
        else:
            (figure,) = figures
            ready[path] = render(figure, ending)
            done()
    for path, content in ready.items():
        write_whole(path, content)

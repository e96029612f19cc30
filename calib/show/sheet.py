"""A sheet: panels of one page, drawn together or one by one.

    Panel  a name, a title, and a function that draws it into its axes
    Sheet  panels, and the rows in which the page shows them

The legend of a panel is between its title and its axes, where it covers no data.
"""

import io
import textwrap
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from string import ascii_letters
from typing import Any

from calib.base.write import write_whole
from calib.show.style import WIDTH, Axes, Figure, styled

_POINTS = 72.0
"""Points to the inch."""
_LETTER = 0.086
"""Width of a letter of the title [in], with a little to spare."""


@dataclass(frozen=True)
class Panel:
    """One pair of axes: ``draw(ax, *data)`` fills it; ``columns`` entries per row of the legend."""

    name: str
    title: str
    draw: Callable[..., None]
    data: tuple[object, ...] = ()
    columns: int = 3

    def fill(self, ax: Axes) -> float:
        """Draw the panel and its legend; returns the height of the legend [pt]."""
        self.draw(ax, *self.data)
        if not ax.get_legend_handles_labels()[1]:
            return 0.0
        legend = ax.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=self.columns)
        return _POINTS * legend.get_window_extent().height / legend.figure.dpi


@dataclass(frozen=True)
class Sheet:
    """The panels of one page, with title and note.

    Attributes
    ----------
    kind : what is drawn: table, stop, simulation, comparison, log and so on.
    name : used in file names.
    title, note : text above the panels and below them.
    panels : all panels; those that ``rows`` does not name are drawn only alone.
    rows : panel names in the layout of the page; a repeated name spans its places.
    heights : relative heights of the rows.
    result : what came out, in a line below the title.
    """

    kind: str
    name: str
    title: str
    note: str
    panels: tuple[Panel, ...]
    rows: tuple[tuple[str, ...], ...]
    heights: tuple[float, ...] = ()
    result: str = ""

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the panels."""
        return tuple(panel.name for panel in self.panels)

    def overview(self) -> Figure:
        """The page: A4 wide, about 2.5 in per row."""
        from matplotlib.figure import Figure

        heights = self.heights or (1.0,) * len(self.rows)
        panels = {panel.name: panel for panel in self.panels}
        with styled():
            figure = Figure(figsize=(WIDTH, 2.5 * sum(heights) + 0.8), layout="constrained")
            places = figure.subplot_mosaic([list(r) for r in self.rows], height_ratios=heights)
            legends = {n: panels[n].fill(ax) for n, ax in places.items()}
            top = {n: next(i for i, row in enumerate(self.rows) if n in row) for n in places}
            for i, (name, ax) in enumerate(places.items()):
                # titles of one row are at one height
                room = max(legends[n] for n in places if top[n] == top[name])
                ax.set_title(f"({ascii_letters[i]}) {panels[name].title}", pad=4.0 + room)
            _frame(figure, self, 150)
        return figure

    def figure(self, name: str) -> Figure:
        """One panel on its own. Raises KeyError for a name that the sheet does not have."""
        from matplotlib.figure import Figure

        panel = {panel.name: panel for panel in self.panels}[name]
        with styled():
            figure = Figure(figsize=(WIDTH * 0.85, 4.4), layout="constrained")
            ax = figure.subplots()
            ax.set_title(panel.title, pad=4.0 + panel.fill(ax))
            _frame(figure, self, 125)
        return figure


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


def render(figure: Figure, ending: str) -> bytes:
    """Bytes of one figure as ``.png``, ``.svg`` or ``.pdf``. Raises KeyError for another ending."""
    with styled():
        buffer = io.BytesIO()
        figure.savefig(buffer, format=ending[1:], metadata=_METADATA[ending])
        return buffer.getvalue()


def _render_pages(figures: list[Figure], done: Callable[[], None] = lambda: None) -> bytes:
    """Bytes of one PDF with a page for each figure; ``done`` is called after each."""
    from matplotlib.backends.backend_pdf import PdfPages

    buffer = io.BytesIO()
    with styled(), PdfPages(buffer, metadata=_METADATA[".pdf"]) as pages:
        for figure in figures:
            figure.savefig(pages, format="pdf")
            done()
    return buffer.getvalue()


def save(pages: dict[Path, list[Figure]], done: Callable[[], None] = lambda: None) -> None:
    """Write each file with its pages; all are drawn before the first is written.

    ``done`` is called after each page is drawn. A file other than a PDF takes one page. Raises
    KeyError for an unknown ending, ValueError for too many pages, OSError if a file cannot be
    written.
    """
    ready = {path: _content(path, figures, done) for path, figures in pages.items()}
    for path, content in ready.items():
        write_whole(path, content)


def _content(path: Path, figures: list[Figure], done: Callable[[], None]) -> bytes:
    ending = path.suffix.lower()
    if ending == ".pdf":
        return _render_pages(figures, done)
    (figure,) = figures
    content = render(figure, ending)
    done()
    return content

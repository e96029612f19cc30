"""A sheet: the panels of one page, drawn together or one by one, and written into files."""

import io
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import cached_property
from itertools import pairwise
from pathlib import Path
from string import ascii_letters
from typing import Any

from calib.base.write import write_whole
from calib.show.numbers import unbroken
from calib.show.panel import PARTS, Panel
from calib.show.style import HEIGHT, WIDTH, Figure, styled


@dataclass(frozen=True)
class Sheet:
    """The panels of one page.

    All ``rows`` have the same number of places; a panel that spans several places is named in each
    of them. A panel that no row names is drawn only alone.
    """

    kind: str  # table, stop, simulation, log and so on
    name: str  # name of the table, stop or log, for file names
    panels: tuple[Panel, ...]
    rows: tuple[tuple[str, ...], ...] = ()  # names of panels; () for one panel in each row
    heights: tuple[float, ...] = (1.0,)  # of each row, or of all rows, in units of 2.5 in
    title: str = ""
    note: str = ""  # below the panels
    result: str = ""  # in short, below the title

    @cached_property
    def by_name(self) -> dict[str, Panel]:
        """Panels by their names."""
        return {panel.name: panel for panel in self.panels}

    @property
    def names(self) -> tuple[str, ...]:
        """Names of the panels."""
        return tuple(self.by_name)

    @property
    def grid(self) -> tuple[tuple[str, ...], ...]:
        """Names of the panels in each row of the page."""
        return self.rows or tuple((name,) for name in self.names)

    @property
    def laid_out(self) -> tuple[str, ...]:
        """Names of the panels of the page, from its top to its bottom."""
        return tuple(dict.fromkeys(name for row in self.grid for name in row))

    def overview(self) -> Figure:
        """Draw the page: A4 wide, and at most A4 high."""
        from matplotlib.figure import Figure

        rows, unlabelled = self.grid, self._unlabelled()
        heights = self.heights if len(self.heights) == len(rows) else self.heights * len(rows)
        with styled():
            height = min(2.5 * sum(heights) + 0.8, HEIGHT)
            figure = Figure(figsize=(WIDTH, height), layout="constrained")
            axes = figure.subplot_mosaic([list(row) for row in rows], height_ratios=heights)
            legend_heights = {name: self.by_name[name].draw(ax) for name, ax in axes.items()}  # pt
            for letter, (name, ax) in zip(ascii_letters, axes.items(), strict=False):
                # the titles of a row are at one height, above its highest legend
                row = next(row for row in rows if name in row)
                room = max(legend_heights[neighbour] for neighbour in row)
                title = self.by_name[name].title
                ax.set_title(f"({letter}) {title}" if len(axes) > 1 else title, pad=4.0 + room)
                if name in unlabelled:
                    ax.set_xlabel("")
                    ax.tick_params(labelbottom=False)
            _frame(figure, self, note_letters=150)
        return figure

    def _unlabelled(self) -> set[str]:
        """Names of the panels whose x axis is labelled at a panel of the same width below."""
        names = set[str]()
        for upper, lower in pairwise(self.grid):
            for above, below in zip(upper, lower, strict=True):
                is_as_wide = upper.count(above) == lower.count(below)  # in places of a row
                has_same_x = self.by_name[above].shares_x(self.by_name[below])
                if above != below and is_as_wide and has_same_x:
                    names.add(above)
        return names

    def figure(
        self, name: str, size: tuple[float, float] = (0.85 * WIDTH, 4.4), parts: int = PARTS
    ) -> Figure:
        """Draw the panel ``name`` alone, in a ``size`` of width and height [in].

        A long line is drawn as an `envelope` of ``parts``. Raises KeyError for an unknown name.
        """
        from matplotlib.figure import Figure

        panel = self.by_name[name]
        with styled():
            figure = Figure(figsize=size, layout="constrained")
            ax = figure.subplots()
            ax.set_title(panel.title, pad=4.0 + panel.draw(ax, parts))
            _frame(figure, self, note_letters=125)
        return figure


def rows_of(names: Sequence[str], columns: int) -> tuple[tuple[str, ...], ...]:
    """Return the ``names`` in rows of ``columns`` places; the last name fills the last row.

    >>> rows_of(["a", "b", "c"], 2)
    (('a', 'b'), ('c', 'c'))
    """
    filled = [*names, *[names[-1]] * (-len(names) % columns)]
    return tuple(tuple(filled[i : i + columns]) for i in range(0, len(filled), columns))


def _frame(figure: Figure, sheet: Sheet, note_letters: int) -> None:
    """Write title and result above the panels, and the note below, ``note_letters`` in a line."""
    letters = int(figure.get_figwidth() / 0.09)  # a letter of the title is at most 0.09 in wide
    result = textwrap.wrap(unbroken(sheet.result), letters)
    figure.suptitle("\n".join([sheet.title, *result]), x=0.012, ha="left")
    if sheet.note:
        text = "\n".join(textwrap.wrap(unbroken(sheet.note), note_letters))
        figure.supxlabel(text, x=0.012, ha="left", fontsize=7.0, color="#444444")


_METADATA: dict[str, dict[str, Any]] = {
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": "brake-cal"},
    ".pdf": {"CreationDate": None, "Producer": "brake-cal", "Creator": "brake-cal"},
}
"""Metadata of a file by its ending; a time or a version would change the bytes."""
ENDINGS = tuple(_METADATA)


def is_picture(data: bytes) -> bool:
    """Return whether the bytes of a file begin like those of PNG, SVG or PDF."""
    return data.startswith((b"\x89PNG", b"<?xml", b"%PDF"))


def render(figure: Figure, ending: str, text: bool = False) -> bytes:
    """Return a figure as a file with an ending of `ENDINGS`; letters of an SVG can be ``text``."""
    with styled(outlines=not text):
        buffer = io.BytesIO()
        figure.savefig(buffer, format=ending[1:], metadata=_METADATA[ending])
        return buffer.getvalue()


def save(pages: dict[Path, list[Figure]], step: Callable[[], None] = lambda: None) -> None:
    """Write the ``pages`` of each file; only a PDF can have several.

    All pages are drawn before the first file is written; ``step`` is called after each page. Raises
    KeyError for an unknown ending, ValueError for too many pages, OSError as `write_whole`.
    """
    ready = {}
    for path, figures in pages.items():
        ending = path.suffix.lower()
        if ending == ".pdf":
            from matplotlib.backends.backend_pdf import PdfPages

            buffer = io.BytesIO()
            with styled(), PdfPages(buffer, metadata=_METADATA[ending]) as book:
                for figure in figures:
                    figure.savefig(book, format="pdf")
                    step()
            ready[path] = buffer.getvalue()
        else:
            (figure,) = figures
            ready[path] = render(figure, ending)
            step()
    for path, content in ready.items():
        write_whole(path, content)

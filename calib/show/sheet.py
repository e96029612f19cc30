"""A sheet: the panels of one page, drawn together or one by one, and written into files."""

import io
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from string import ascii_letters
from typing import Any

from calib.base.write import write_whole
from calib.show.numbers import unbroken
from calib.show.panel import PARTS, Panel
from calib.show.style import HEIGHT, WIDTH, Figure, styled

_LETTER = 0.09
"""Width of a letter of the title [in], rounded up."""


@dataclass(frozen=True)
class Sheet:
    """The panels of one page.

    Attributes
    ----------
    kind : what is drawn: table, stop, simulation, log and so on.
    name : name of what is drawn, for file names.
    panels : all panels; a panel that ``rows`` does not name is drawn only alone.
    rows : names of the panels in each row of the page, () for one panel a row. All rows have as
        many places; a panel that spans several places is named in each of them.
    heights : height of each row in units of 2.5 in; a single value is for all rows.
    title, note : text above the panels and below them.
    result : the answer in short, below the title.
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
        """Names of the panels of the page, from its top to its bottom."""
        return tuple(dict.fromkeys(name for row in self.rows for name in row)) or self.names

    def overview(self) -> Figure:
        """Draw the page: A4 wide, and at most A4 high."""
        from matplotlib.figure import Figure

        rows = self.rows or tuple((name,) for name in self.names)
        heights = self.heights if len(self.heights) == len(rows) else self.heights * len(rows)
        panels, unlabelled = {panel.name: panel for panel in self.panels}, self._unlabelled()
        with styled():
            height = min(2.5 * sum(heights) + 0.8, HEIGHT)
            figure = Figure(figsize=(WIDTH, height), layout="constrained")
            axes = figure.subplot_mosaic([list(row) for row in rows], height_ratios=heights)
            legend_heights = {name: panels[name].draw(ax) for name, ax in axes.items()}  # [points]
            for letter, (name, ax) in zip(ascii_letters, axes.items(), strict=False):
                row = next(row for row in rows if name in row)
                # the titles of a row are at one height, above its highest legend
                room = max(legend_heights[beside] for beside in row)
                title = panels[name].title
                ax.set_title(f"({letter}) {title}" if len(axes) > 1 else title, pad=4.0 + room)
                if name in unlabelled:
                    ax.set_xlabel("")
                    ax.tick_params(labelbottom=False)
            _frame(figure, self, 150)
        return figure

    def _unlabelled(self) -> set[str]:
        """Names of the panels whose x axis is labelled at a panel of the same width below."""
        panels, names = {panel.name: panel for panel in self.panels}, set[str]()
        for upper, lower in pairwise(self.rows or [(name,) for name in self.names]):
            for above, below in zip(upper, lower, strict=True):
                is_as_wide = above != below and upper.count(above) == lower.count(below)
                if is_as_wide and panels[above].shares_x(panels[below]):
                    names.add(above)
        return names

    def figure(
        self, name: str, size: tuple[float, float] = (0.85 * WIDTH, 4.4), parts: int = PARTS
    ) -> Figure:
        """Draw the panel ``name`` alone, in a ``size`` of width and height [in].

        A long line is drawn as an `envelope` of ``parts``. Raises KeyError for an unknown name.
        """
        from matplotlib.figure import Figure

        panel = {panel.name: panel for panel in self.panels}[name]
        with styled():
            figure = Figure(figsize=size, layout="constrained")
            ax = figure.subplots()
            ax.set_title(panel.title, pad=4.0 + panel.draw(ax, parts))
            _frame(figure, self, 125)
        return figure


def rows_of(names: Sequence[str], columns: int) -> tuple[tuple[str, ...], ...]:
    """Return the ``names`` in rows of ``columns`` places; the last name fills its row.

    >>> rows_of(["a", "b", "c"], 2)
    (('a', 'b'), ('c', 'c'))
    """
    filled = [*names, *[names[-1]] * (-len(names) % columns)]
    return tuple(tuple(filled[i : i + columns]) for i in range(0, len(filled), columns))


def _frame(figure: Figure, sheet: Sheet, width: int) -> None:
    """Write title and result above the panels, and the note, ``width`` letters wide, below them."""
    letters = int(figure.get_figwidth() / _LETTER)
    lines = (sheet.title, *textwrap.wrap(unbroken(sheet.result), letters))
    figure.suptitle("\n".join(lines), x=0.012, ha="left")
    if sheet.note:
        text = "\n".join(textwrap.wrap(unbroken(sheet.note), width))
        figure.supxlabel(text, x=0.012, ha="left", fontsize=7.0, color="#444444")


_METADATA: dict[str, dict[str, Any]] = {
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": "brake-cal"},
    ".pdf": {"CreationDate": None, "Producer": "brake-cal", "Creator": "brake-cal"},
}
"""Metadata of a file by its ending, without a time and a version, which would change bytes."""
ENDINGS = tuple(_METADATA)
_BEGINS = (b"\x89PNG", b"<?xml", b"%PDF")
"""First bytes of a file, one for each of the `ENDINGS`."""


def is_picture(data: bytes) -> bool:
    """Return whether the bytes of a file begin like those of a picture."""
    return data.startswith(_BEGINS)


def render(figure: Figure, ending: str, text: bool = False) -> bytes:
    """Return a figure as the bytes of a file with an ``ending`` of `ENDINGS`.

    An SVG with letters as ``text`` has half the size, and the font of the machine that shows it.
    """
    with styled(outlines=not text):
        buffer = io.BytesIO()
        figure.savefig(buffer, format=ending[1:], metadata=_METADATA[ending])
        return buffer.getvalue()


def save(pages: dict[Path, list[Figure]], step: Callable[[], None] = lambda: None) -> None:
    """Write each file with its pages, of which only a PDF can have several.

    All pages are drawn before the first file is written; ``step`` is called after each page. Raises
    KeyError for an unknown ending, ValueError for too many pages, OSError as `write_whole`.
    """
    ready = {}
    for path, figures in pages.items():
        ending, buffer = path.suffix.lower(), io.BytesIO()
        if ending == ".pdf":
            from matplotlib.backends.backend_pdf import PdfPages

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

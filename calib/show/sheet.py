"""A sheet: panels of one page, the rows in which it shows them, drawn together or one by one."""

import io
import textwrap
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from string import ascii_letters
from typing import Any

from calib.base.write import write_whole
from calib.show.numbers import whole
from calib.show.panel import PARTS, Panel
from calib.show.style import HEIGHT, WIDTH, Figure, styled

_LETTER = 0.09
"""Width of a letter of the title [in], with a little to spare."""


@dataclass(frozen=True)
class Sheet:
    """The panels of one page.

    Attributes
    ----------
    kind : what is drawn: table, stop, simulation, log and so on.
    name : used in file names.
    panels : all panels; those that ``rows`` does not name are drawn only alone.
    rows : names of the panels of the page, repeated where one spans places; () for a row each.
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
            if up != down
            and upper.count(up) == lower.count(down)
            and panels[up].shares(panels[down])
        }
        with styled():
            height = min(2.5 * sum(heights) + 0.8, HEIGHT)
            figure = Figure(figsize=(WIDTH, height), layout="constrained")
            places = figure.subplot_mosaic([list(r) for r in rows], height_ratios=heights)
            legends = {n: panels[n].fill(ax) for n, ax in places.items()}
            first_row = {n: next(i for i, row in enumerate(rows) if n in row) for n in places}
            for i, (name, ax) in enumerate(places.items()):
                # titles of one row are at one height
                room = max(legends[n] for n in places if first_row[n] == first_row[name])
                letter = f"({ascii_letters[i]}) " * (len(places) > 1)
                ax.set_title(letter + panels[name].title, pad=4.0 + room)
                if name in above:
                    ax.set_xlabel("")
                    ax.tick_params(labelbottom=False)
            _frame(figure, self, 150)
        return figure

    def figure(
        self, name: str, size: tuple[float, float] = (0.85 * WIDTH, 4.4), parts: int = PARTS
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
    lines = (sheet.title, *textwrap.wrap(whole(sheet.result), int(figure.get_figwidth() / _LETTER)))
    figure.suptitle("\n".join(lines), x=0.012, ha="left")
    if sheet.note:
        text = "\n".join(textwrap.wrap(whole(sheet.note), width))
        figure.supxlabel(text, x=0.012, ha="left", fontsize=7.0, color="#444444")


_METADATA: dict[str, dict[str, Any]] = {
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": "brake-cal"},
    ".pdf": {"CreationDate": None, "Producer": "brake-cal", "Creator": "brake-cal"},
}
"""Metadata of a file by ending; no time and no version, which would change the bytes."""
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


def save(pages: dict[Path, list[Figure]], step: Callable[[], None] = lambda: None) -> None:
    """Write each file with its pages; all are drawn before the first is written.

    ``step`` is called after each page is drawn. A file other than a PDF takes one page. Raises
    KeyError for an unknown ending, ValueError for too many pages, OSError if a file cannot be
    written.
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

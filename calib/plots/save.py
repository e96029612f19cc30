"""Figures to bytes and files. The same figure always gives the same bytes.

PNG and SVG hold one page each; a PDF holds as many as there are.
"""

import io
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

from calib.files.write import write_whole
from calib.plots.style import styled

if TYPE_CHECKING:
    from matplotlib.figure import Figure

# No time and no version of matplotlib in a file: they would change the bytes.
METADATA: dict[str, dict[str, Any]] = {
    ".png": {"Software": None},
    ".svg": {"Date": None, "Creator": "brake-cal"},
    ".pdf": {"CreationDate": None, "Producer": "brake-cal", "Creator": "brake-cal"},
}
"""Metadata of a file by ending; the keys are the endings that are known."""

ENDINGS = tuple(METADATA)


BEGINS = (b"\x89PNG", b"<?xml", b"%PDF")
"""First bytes of a file by each ending."""


def is_picture(data: bytes) -> bool:
    """Whether the bytes of a file are those of a picture as it is written here."""
    return data.startswith(BEGINS)


def render(figure: "Figure", ending: str) -> bytes:
    """Bytes of one figure as ``.png``, ``.svg`` or ``.pdf``. Raises KeyError for another ending."""
    with styled():
        buffer = io.BytesIO()
        figure.savefig(buffer, format=ending[1:], metadata=METADATA[ending])
        return buffer.getvalue()


def render_pages(figures: "list[Figure]", done: Callable[[], None] = lambda: None) -> bytes:
    """Bytes of one PDF with a page for each figure; ``done`` is called after each."""
    from matplotlib.backends.backend_pdf import PdfPages

    buffer = io.BytesIO()
    with styled(), PdfPages(buffer, metadata=METADATA[".pdf"]) as pages:
        for figure in figures:
            figure.savefig(pages, format="pdf")
            done()
    return buffer.getvalue()


def save(pages: "dict[Path, list[Figure]]", done: Callable[[], None] = lambda: None) -> None:
    """Write each file with its pages; all are drawn before the first is written.

    ``done`` is called after each page is drawn. A file other than a PDF takes one page. Raises
    KeyError for an unknown ending, ValueError for too many pages, OSError if a file cannot be
    written.
    """
    ready = {path: _content(path, figures, done) for path, figures in pages.items()}
    for path, content in ready.items():
        write_whole(path, content)


def _content(path: Path, figures: "list[Figure]", done: Callable[[], None]) -> bytes:
    ending = path.suffix.lower()
    if ending == ".pdf":
        return render_pages(figures, done)
    (figure,) = figures
    content = render(figure, ending)
    done()
    return content

import hashlib
import os
import re
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

from calib.show import table
from calib.show.sheet import ENDINGS, Panel, Sheet, render, render_pages, save
from calib.show.style import styled
from tests.support.tables import made_table

UNIT = re.compile(r".+ \[.+\]$")


@pytest.fixture(scope="module")
def page(sheet):
    return sheet.overview()


@pytest.fixture(scope="module")
def renderer(page):
    """Renderer of a page that has been drawn once, so that everything has its place."""
    with styled():
        canvas = FigureCanvasAgg(page)
        canvas.draw()
        return canvas.get_renderer()


def text_of(artist, words):
    """The text with these words, on a page or in a pair of axes."""
    return next(text for text in artist.findobj(Text) if text.get_text() == words)


def has_name(axis):
    """A name with a unit; places that are words, or no places at all, need none."""
    words = any(re.search("[a-z]{3}", tick.get_text()) for tick in axis.get_ticklabels())
    return words or not axis.get_ticklocs().size or UNIT.match(axis.get_label_text())


def test_every_axis_has_a_name_and_a_unit(page):
    for ax in page.axes:
        assert has_name(ax.xaxis), ax.get_title(loc="left")
        assert has_name(ax.yaxis), ax.get_title(loc="left")
        assert ax.get_title(loc="left")


def test_the_page_shows_the_panels_of_its_rows(sheet, page):
    shown = {name for row in sheet.rows for name in row}
    assert shown <= set(sheet.names)
    assert len(page.axes) == len(shown)
    assert len(set(sheet.names)) == len(sheet.names)


def test_legends_stand_above_the_data(page, renderer):
    for ax in page.axes:
        if (legend := ax.get_legend()) is not None:
            box = legend.get_window_extent(renderer)
            assert box.y0 >= ax.get_window_extent(renderer).y1 - 1.0, ax.get_title(loc="left")
            title = text_of(ax, ax.get_title(loc="left")).get_window_extent(renderer)
            assert title.y0 >= box.y1 - 4.0, ax.get_title(loc="left")


def test_nothing_is_cut_off_and_panels_do_not_touch(page, renderer):
    boxes = [ax.get_tightbbox(renderer) for ax in page.axes]
    for box in boxes:
        assert box.x0 >= 0.0
        assert box.y0 >= 0.0
        assert box.x1 <= page.bbox.x1
        assert box.y1 <= page.bbox.y1
    for i, a in enumerate(boxes):
        for b in boxes[:i]:
            overlap = min(a.x1, b.x1) - max(a.x0, b.x0), min(a.y1, b.y1) - max(a.y0, b.y0)
            assert min(overlap) <= 6.0  # pixels of 100 to the inch
    note = text_of(page, page.get_supxlabel()).get_window_extent(renderer)
    assert note.x1 <= page.bbox.x1


def test_each_panel_stands_alone(sheet):
    for name in sheet.names:
        (ax,) = sheet.figure(name).axes
        assert ax.lines or ax.collections
        assert has_name(ax.xaxis)
        assert has_name(ax.yaxis)


def test_an_unknown_panel_is_an_error(sheet):
    with pytest.raises(KeyError):
        sheet.figure("pie")


def test_a_panel_without_labels_has_no_legend():
    def draw(ax):
        ax.plot(np.arange(3.0), np.arange(3.0))

    sheet = Sheet("log", "x", "x", "", (Panel("a", "A", draw),), (("a",),))
    (ax,) = sheet.overview().axes
    assert ax.get_legend() is None


def test_what_came_out_stands_below_the_title_and_is_not_cut():
    def draw(ax):
        ax.set(xlabel="x [1]", ylabel="y [1]")

    words = "Failed: " + "; ".join(f"a metric {i} is too large" for i in range(8))
    sheet = Sheet("log", "x", "Log x", "", (Panel("a", "A", draw),), (("a",),), result=words)
    page = sheet.overview()
    first, *rest = page.get_suptitle().split("\n")
    assert first == "Log x"
    assert " ".join(rest) == words
    with styled():
        canvas = FigureCanvasAgg(page)
        canvas.draw()
        box = text_of(page, page.get_suptitle()).get_window_extent(canvas.get_renderer())
    assert box.x1 <= page.bbox.x1
    assert box.y1 <= page.bbox.y1


MAGIC = {".png": b"\x89PNG\r\n\x1a\n", ".svg": b"<?xml", ".pdf": b"%PDF-"}
ROOT = Path(__file__).parents[2]


@pytest.fixture
def figure():
    return table.sheet(made_table(), "sedan@1").figure("coverage")


def test_the_endings_are_these():
    assert set(ENDINGS) == set(MAGIC)


@pytest.mark.parametrize("ending", MAGIC)
def test_an_ending_gives_its_format_whole(figure, ending):
    content = render(figure, ending)
    assert content.startswith(MAGIC[ending])
    end = {".png": b"IEND\xaeB`\x82", ".svg": b"</svg>", ".pdf": b"%%EOF"}[ending]
    assert content.rstrip().endswith(end)


@pytest.mark.parametrize("ending", MAGIC)
def test_the_same_figure_gives_the_same_bytes_in_another_process(figure, ending):
    code = (
        "import hashlib; from calib.show import table; from calib.show.sheet import render; "
        "from tests.support.tables import made_table; "
        "figure = table.sheet(made_table(), 'sedan@1').figure('coverage'); "
        f"print(hashlib.sha256(render(figure, {ending!r})).hexdigest())"
    )
    run = subprocess.run(
        [sys.executable, "-c", code],
        cwd=ROOT,
        # another year, another order of sets
        env={**os.environ, "PYTHONHASHSEED": "7", "SOURCE_DATE_EPOCH": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    assert run.stdout.strip() == hashlib.sha256(render(figure, ending)).hexdigest()


@pytest.mark.parametrize("ending", MAGIC)
def test_a_file_says_nothing_of_the_time(figure, ending):
    content = render(figure, ending)
    for word in (b"CreationDate", b"dc:date", b"tIME"):
        assert word not in content


def test_a_pdf_holds_all_pages(figure):
    content = render_pages([figure, figure])
    assert content.count(b"/Type /Page ") == 2
    assert render_pages([figure, figure]) == content


def test_every_page_is_reported(figure, tmp_path):
    told = []
    save({tmp_path / "a.pdf": [figure] * 2, tmp_path / "b.svg": [figure]}, lambda: told.append(1))
    assert len(told) == 3
    assert sorted(p.name for p in tmp_path.iterdir()) == ["a.pdf", "b.svg"]


def test_nothing_is_written_when_one_cannot_be_drawn(figure, tmp_path):
    (tmp_path / "a.png").write_bytes(b"old")
    with pytest.raises(KeyError):
        save({tmp_path / "a.png": [figure], tmp_path / "b.jpg": [figure]})
    assert [p.name for p in tmp_path.iterdir()] == ["a.png"]
    assert (tmp_path / "a.png").read_bytes() == b"old"


def test_a_png_takes_one_page(figure, tmp_path):
    with pytest.raises(ValueError, match="too many values"):
        save({tmp_path / "a.png": [figure, figure]})

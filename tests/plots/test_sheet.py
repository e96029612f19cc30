import re

import numpy as np
import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

from calib.plots.sheet import Panel, Sheet
from calib.plots.style import styled

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

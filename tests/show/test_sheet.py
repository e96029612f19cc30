import hashlib
import os
import re
import subprocess
import sys
from pathlib import Path

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.text import Text

from calib.show import table
from calib.show.sheet import ENDINGS, render
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
    """Return the text with these words, on a page or in a pair of axes."""
    return next(text for text in artist.findobj(Text) if text.get_text() == words)


def has_name(axis):
    words = [text.get_text() for text in axis.get_ticklabels()]
    return UNIT.match(axis.get_label_text()) or all(word[:1].isalpha() for word in words)


def test_every_axis_has_a_name_and_a_unit(page):
    """An x axis that goes on in the panel below has them there."""
    for ax in page.axes:
        if ax.xaxis.get_tick_params()["labelbottom"]:
            assert has_name(ax.xaxis), ax.get_title(loc="left")
        assert has_name(ax.yaxis), ax.get_title(loc="left")
        assert ax.get_title(loc="left")


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
        assert min(box.x0, box.y0) >= 0.0
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


ROOT = Path(__file__).parents[2]
CODE = """
import hashlib
from calib.show import table
from calib.show.sheet import ENDINGS, render
from tests.support.tables import made_table
figure = table.table_sheet(made_table(), 'sedan@1').figure('f1-f2')
print(*(hashlib.sha256(render(figure, ending)).hexdigest() for ending in ENDINGS))
"""


def test_the_same_figure_gives_the_same_bytes_in_another_process():
    figure = table.table_sheet(made_table(), "sedan@1").figure("f1-f2")
    run = subprocess.run(
        [sys.executable, "-c", CODE],
        cwd=ROOT,
        # another year, another order of sets
        env={**os.environ, "PYTHONHASHSEED": "7", "SOURCE_DATE_EPOCH": "1"},
        capture_output=True,
        text=True,
        check=True,
    )
    digests = [hashlib.sha256(render(figure, ending)).hexdigest() for ending in ENDINGS]
    assert run.stdout.split() == digests

"""A sheet in the browser: all samples, panels that zoom together, and no request."""

import json

import numpy as np
import pytest

from calib.show.facts import Facts, Picture
from calib.show.html import page_of
from calib.show.interactive import drawn
from calib.show.panel import Line, Mark, Panel
from calib.show.sheet import Sheet
from calib.show.style import DASHED, FRONT, REAR, as_text
from tests.support.browser import ask, needs_browser, opened

TIME = np.arange(1001) / 200.0
WAVE, BAND = np.sin(TIME), (np.sin(TIME) - 0.1, np.sin(TIME) + 0.1)
RINGS = {"color": "#0072B2", "linestyle": "", "marker": "o"}
NAME = as_text("</script>$$x$$ \\\\[y\\\\] &<b>")
"""A name that would end a script, begin a formula of MathJax, and be markup."""


def over_time(name, *lines, **more):
    return Panel(name, NAME, "time [s]", "y [1]", lines, xlim=(0.0, 5.0), **more)


@pytest.fixture(scope="module")
def sheet():
    gap = np.where(TIME < 1.0, np.nan, WAVE)
    marks = [Mark(1.0, 1.0, {**REAR, "linestyle": DASHED}, NAME), Mark(2.0, 3.0, REAR, "part")]
    return Sheet(
        "made",
        "made",
        (
            over_time("a", Line(TIME, gap, FRONT, NAME, BAND), Line(TIME, WAVE, REAR, "rear")),
            over_time("b", Line(TIME, WAVE, FRONT, mean=0.1), marks=marks),
            Panel("c", "curve", "eta [%]", "D [1]", [
                Line(2.0 * TIME, 3.0 * TIME, FRONT, "curve"),
                Line([1.0, 2.0], [1.0, 2.0], RINGS, "rings"),
            ], texts=[(NAME, 1.0, 1.0)]),
        ),
    )  # fmt: skip


@pytest.fixture(scope="module")
def page(sheet, tmp_path_factory):
    path = tmp_path_factory.mktemp("live") / "page.html"
    path.write_text(page_of(Facts("made", pictures=[Picture("made", lambda: sheet)]), live=True))
    return path


def test_all_samples_of_a_line_are_in_the_page_once(sheet):
    made = drawn(sheet, sheet.names, "x")
    assert list(made.places) == ["a", "b", "c"]
    assert sorted(made.roots.values()) == ["x-0", "x-1", "x-2"]
    found = [
        value["array"]["data"]
        for value in every(json.loads(made.data))
        if value.get("type") == "ndarray" and value.get("shape") == [TIME.size]
    ]
    # x of both; of them y, the ends of a band, a mean; of the curve its x and y
    assert len(found) == 9


def every(value):
    """All dicts in a document."""
    if isinstance(value, dict):
        yield value
        value = list(value.values())
    if isinstance(value, list):
        for one in value:
            yield from every(one)


def test_a_live_page_is_printed_as_any_other(sheet):
    facts = Facts("made", pictures=[Picture("made", lambda: sheet)])
    still, live = page_of(facts), page_of(facts, live=True)
    assert "<script" not in still
    assert still.count("<img") == live.count('<img class="still"') == 3


@needs_browser
@pytest.mark.parametrize(("width", "dark"), [(1000, True), (360, False)])
def test_it_opens_without_a_request_and_fits_the_screen(browser, page, width, dark):
    requests, told = opened(browser, page, width, dark)
    assert requests == []
    assert [one for one in told if one["level"] != "INFO"] == []
    assert ask(browser, "document.documentElement.scrollWidth") <= width
    size = "[...document.querySelectorAll('.live')].map(e => [e.clientWidth, e.clientHeight])"
    assert all(w > 300 and h > 200 for w, h in ask(browser, size))
    hidden = "[...document.images].every(i => i.clientWidth == 0)"
    assert ask(browser, hidden)


@needs_browser
def test_panels_over_one_axis_zoom_together(browser, page):
    opened(browser, page)
    browser.execute_script("Bokeh.documents[0].roots()[0].x_range.setv({start: 2, end: 3})")
    ends = ask(browser, "Bokeh.documents[0].roots().map(r => [r.x_range.start, r.x_range.end])")
    assert ends[0] == ends[1] == [2, 3]
    assert ends[2] != [2, 3]

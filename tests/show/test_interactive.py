"""A sheet in the browser has all samples, zooms its panels together, and sends no request."""

import json
import re
from urllib.parse import unquote
from xml.dom.minidom import parseString

import numpy as np
import pytest
from selenium.webdriver import ActionChains
from selenium.webdriver.support.ui import WebDriverWait

from calib.line.gauge.study import study
from calib.show.facts import Facts, Picture, Table
from calib.show.html import page_of
from calib.show.interactive import script_of
from calib.show.panel import Field, Line, Mark, Panel
from calib.show.repeatability import gauge_facts
from calib.show.sheet import Sheet
from calib.show.style import DASHED, FRONT, REAR, as_text
from tests.line.gauge.test_study import readings
from tests.support.browser import ask, needs_browser, opened

TIME = np.arange(1001) / 200.0
WAVE, BAND = np.sin(TIME), (np.sin(TIME) - 0.1, np.sin(TIME) + 0.1)
RINGS = {"color": "#0072B2", "linestyle": "", "marker": "o"}
SLICES = [np.full((2, 2), float(i)) for i in range(4)]
MAP = Field(
    np.ones((2, 2)), (0.0, 1.0, 0.0, 1.0), 1.0, SLICES, ("slip", -3.0, 3.0), (9.0, 6.0, 2.0)
)
NAME = as_text("</script>$$x$$ \\\\[y\\\\] &<b>")
"""A name that would end a script, begin a formula of MathJax, and be markup."""


def over_time(name, *lines, **more):
    return Panel(name, NAME, "time [s]", "y [1]", lines, xlim=(0.0, 5.0), **more)


@pytest.fixture(scope="module")
def sheet():
    gap = np.where(TIME < 1.0, np.nan, WAVE)
    marks = [Mark(1.0, 1.0, {**REAR, "linestyle": DASHED}, NAME), Mark(2.0, 3.0, REAR, "part")]
    curve = Line(2.0 * TIME, 3.0 * TIME, FRONT, "curve")
    rings = Line([1.0, 2.0], [1.0, 2.0], RINGS, "rings")
    words = {"texts": [(NAME, 1.0, 1.0)], "xticks": ["of two\nlines", "it's"]}
    panels = (
        over_time("a", Line(TIME, gap, FRONT, NAME, BAND), Line(TIME, WAVE, REAR, "rear")),
        over_time("b", Line(TIME, WAVE, FRONT, mean=0.1), marks=marks),
        Panel("c", "curve", "eta [%]", "D [1]", [curve, rings], **words),
        Panel("d", "map", "eta [%]", "z [1]", [], field=MAP, xlim=(0.0, 1.0), ylim=(0.0, 1.0)),
    )
    return Sheet("made", "made", panels)


@pytest.fixture(scope="module")
def page(sheet, tmp_path_factory):
    path = tmp_path_factory.mktemp("live") / "page.html"
    path.write_text(page_of(Facts("made", pictures=[Picture("made", lambda: sheet)]), live=True))
    return path


def test_all_samples_of_a_line_are_in_the_page_once(sheet):
    script = script_of(sheet, {name: f"place-{name}" for name in sheet.names})
    document, end = json.JSONDecoder().raw_decode(script.removeprefix("live("))
    assert script[end:].count("place-") == 4
    arrays = [value for value in dicts_in(document) if value.get("type") == "ndarray"]
    columns = [array for array in arrays if array["shape"] == [TIME.size]]
    # x of both; of them y, the ends of a band, a mean; of the curve its x and y
    assert len(columns) == 9


def test_marks_lie_behind_the_lines(sheet):
    document, _ = json.JSONDecoder().raw_decode(script_of(sheet, {"b": "x"}).removeprefix("live("))
    models = [x for x in dicts_in(document["roots"]) if x.get("name") == "GlyphRenderer"]
    glyphs = [model["attributes"] for model in models]
    levels = {glyph["glyph"]["name"]: glyph.get("level", "glyph") for glyph in glyphs}
    assert levels == {"Line": "glyph", "VSpan": "image", "VStrip": "image"}


def dicts_in(value):
    """Yield all dicts in a document."""
    if isinstance(value, dict):
        yield value
        value = list(value.values())
    if isinstance(value, list):
        for part in value:
            yield from dicts_in(part)


def test_a_live_page_is_printed_as_any_other(sheet):
    facts = Facts("made", pictures=[Picture("made", lambda: sheet)])
    still, live = page_of(facts), page_of(facts, live=True)
    assert "<script" not in still
    assert still.count("<img") == live.count("<img") == live.count('class="live"') == 4
    pictures = re.findall(r'src="data:image/svg\+xml,([^"]*)"', still)
    roots = [parseString(unquote(picture)).documentElement for picture in pictures]
    assert [root.tagName for root in roots] == ["svg"] * 4
    assert live == page_of(facts, live=True)


def test_a_page_has_live_pictures_up_to_its_limit(sheet, monkeypatch):
    monkeypatch.setattr("calib.show.html._ROOM", 1)
    page = page_of(Facts("made", pictures=[Picture("made", lambda: sheet)] * 2), live=True)
    assert page.count('class="live"') == 4
    assert page.count("<img") == 8


def test_every_station_of_a_gauge_study_has_a_marker_in_the_browser():
    gauge_study = study(readings(cars=5, stations=7), {})
    page = page_of(gauge_facts(gauge_study), live=True)
    assert page.count('class="live"') == len(gauge_study.results) > 0


def open_drawn(browser, page, *screen):
    """Open a page, wait for its pictures, and return its requests and messages."""
    requests, messages = opened(browser, page, *screen)
    WebDriverWait(browser, 30).until(lambda _: ask(browser, "typeof last != 'undefined'"))
    browser.execute_async_script("last.then(arguments[0])")
    return requests, messages + browser.get_log("browser")


@needs_browser
@pytest.mark.parametrize(("width", "dark"), [(1000, True), (360, False)])
def test_it_opens_without_a_request_and_fits_the_screen(browser, page, width, dark):
    requests, messages = open_drawn(browser, page, width, dark)
    assert requests == []
    assert [message for message in messages if message["level"] != "INFO"] == []
    assert ask(browser, "document.documentElement.scrollWidth") <= width
    size = "[...document.querySelectorAll('.live')].map(e => [e.clientWidth, e.clientHeight])"
    assert all(w > 300 and h > 200 for w, h in ask(browser, size))
    assert ask(browser, "[...document.images].every(i => i.clientWidth == 0)")


@needs_browser
def test_panels_over_one_axis_zoom_together(browser, page):
    open_drawn(browser, page)
    browser.execute_script("Bokeh.documents[0].roots()[0].x_range.setv({start: 2, end: 3})")
    ends = ask(browser, "Bokeh.documents[0].roots().map(r => [r.x_range.start, r.x_range.end])")
    assert ends[0] == ends[1] == [2, 3]
    assert ends[2] != [2, 3]


@needs_browser
def test_two_taps_show_both_values_and_their_difference(browser, page):
    open_drawn(browser, page)
    panel = browser.find_elements("css selector", ".live")[0]

    def tapped(_):
        for right in (-60, 100):
            ActionChains(browser).move_to_element_with_offset(panel, right, 20).click().perform()
        return ask(browser, "document.querySelector('output')?.innerText")

    text = WebDriverWait(browser, 30).until(tapped)  # a busy browser may lose a tap
    (a, b, b_less_a), *_, (first, last, difference) = (
        map(float, re.findall(r"-?[\d.]+(?=$| to|,)", line)) for line in text.splitlines()
    )
    assert b_less_a == pytest.approx(b - a, abs=2e-3)
    assert [first, last] == pytest.approx([np.sin(a), np.sin(b)], abs=0.02)
    assert difference == pytest.approx(last - first, abs=2e-3)


@needs_browser
def test_a_slider_moves_through_the_slices_of_a_map_and_its_torques_are_shown(browser, page):
    open_drawn(browser, page)
    values, text = browser.execute_script("""
        const input = document.querySelector("input"), fig = Bokeh.documents[0].roots()[3];
        input.value = 1.5; input.oninput();
        const source = fig.renderers[0].data_source, hover = fig.toolbar.tools.at(-1);
        const place = {image_index: {flat_index: 3}, x: 0.5, y: 0.5};
        return [[...source.get_column("image")[0]], hover.tooltips(source, place).innerText];
    """)
    assert values == pytest.approx([2.25] * 4, abs=0.01)  # three quarters of the way from 0 to 3
    ratio, front, rear = (float(x) for x in re.findall(r"(?:value:|front|rear) ([\d.]+)", text))
    share = 2.0 * ratio / (1.0 + 2.0 * ratio)  # at a value of 1 the front has two thirds
    assert [front, rear] == pytest.approx([9.0 * 0.5 * share, 6.0 * 0.5 * (1.0 - share)], rel=1e-3)


@needs_browser
def test_a_table_sorts_by_numbers_and_shows_what_failed(browser, tmp_path):
    rows = [("b", "10.5 %"), ("a", "-9 %"), ("d", ""), ("c", "9 %")]
    table = Table(("stop", "error"), rows, verdicts=["passed", "failed", "passed", "warning"])
    path = tmp_path / "page.html"
    path.write_text(page_of(Facts("made", tables=[table]), again=600))
    assert opened(browser, path)[1] == []  # the page allows the digest of its script
    assert ask(browser, "document.querySelector('header input').checked")
    names = """[...document.querySelectorAll("tbody tr")]
        .filter(row => row.clientHeight).map(row => row.cells[0].innerText).join("")"""
    for head, order in ((1, "acbd"), (1, "bcad"), (0, "abcd")):
        browser.find_elements("css selector", "thead button")[head].click()
        assert ask(browser, names) == order
    browser.find_element("css selector", "main > label input").click()
    assert ask(browser, names) == "ac"
    # a head with another box in it would be printed on its first page alone
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": "print"})
    display = "getComputedStyle(document.querySelector('thead button')).display"
    assert ask(browser, display) == "contents"
    browser.execute_cdp_cmd("Emulation.setEmulatedMedia", {"media": ""})

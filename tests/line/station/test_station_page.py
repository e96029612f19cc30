"""The report of a car, read as text and opened in a real browser."""

import re
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise

import numpy as np
import pytest

from calib.show.html import page_of
from calib.show.station_page import report, sheet
from tests.support.browser import BROWSER, Browser
from tests.support.station_run import MARKUP

needs_browser = pytest.mark.skipif(BROWSER is None, reason="no Chromium here; apt install chromium")


@pytest.fixture(scope="module")
def html(found, kept):
    car = replace(found.table.vehicle, name=f"car {MARKUP}")
    return page_of(report(replace(found, table=replace(found.table, vehicle=car)), kept))


@pytest.fixture(scope="module")
def page(html, tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(html)
    return path


@pytest.fixture(scope="module")
def browser(tmp_path_factory):
    with Browser(tmp_path_factory.mktemp("profile")) as opened:
        yield opened


class Reader(HTMLParser):
    """Tags, texts and attributes as a parser finds them that knows nothing of the report."""

    def __init__(self):
        super().__init__()
        self.tags, self.texts, self.attributes = [], [], []

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.attributes.append((tag, dict(attrs)))

    def handle_data(self, data):
        self.texts.append(data)


def read(html):
    reader = Reader()
    reader.feed(html)
    return reader


def test_markup_in_names_stays_text(html):
    seen = read(html)
    assert "script" not in seen.tags
    assert not any("onerror" in attributes for _, attributes in seen.attributes)
    text = "".join(seen.texts)
    assert text.count(MARKUP) >= 5  # serial, vehicle, stop, caveat, table of logs


def test_every_figure_has_a_text_and_every_table_a_caption(html):
    seen = read(html)
    images = [attributes for tag, attributes in seen.attributes if tag == "img"]
    assert len(images) == 6  # the second panel of a figure is told with the first
    assert sum(len(image["alt"]) > 40 for image in images) == 4
    assert seen.tags.count("table") == seen.tags.count("caption")
    assert dict(seen.attributes)["html"] == {"lang": "en"}
    levels = [int(tag[1]) for tag in seen.tags if re.fullmatch("h[1-6]", tag)]
    assert levels[0] == 1
    assert all(b - a <= 1 for a, b in pairwise(levels))


def test_the_verdict_comes_first_and_each_failure_has_a_next_step(html, found):
    texts = [text.strip() for text in read(html).texts if text.strip()]
    assert texts.index("Failed") < texts.index("Limits that are not held.")
    for check in found.with_verdict("failed"):
        assert any(check.text in text for text in texts)


@needs_browser
@pytest.mark.parametrize(("width", "dark"), [(1000, True), (360, False)])
def test_opens_quietly_and_fits_the_screen(browser, page, width, dark):
    seen = browser.open(page, width, dark=dark)
    assert seen.requests == []
    assert seen.complaints == []
    assert browser.ask("document.documentElement.scrollWidth") <= width
    sizes = browser.ask(
        "[...document.images].map(i => [i.complete, i.naturalWidth, i.clientWidth, i.clientHeight])"
    )
    assert len(sizes) == 6
    assert all(done and wide > 300 and w > 300 and h > 100 for done, wide, w, h in sizes)


@needs_browser
def test_no_table_is_cut_and_every_bar_has_its_mark(browser, page):
    browser.open(page, 360)
    cut = "[...document.querySelectorAll('.wide')].filter(e => e.scrollWidth > e.clientWidth + 1)"
    assert browser.ask(f"{cut}.length") == 0
    bars = "[...document.querySelectorAll('.bar')]"
    assert browser.ask(f"{bars}.length") > 15
    assert browser.ask(f"{bars}.every(e => e.querySelector('.mark') && e.ariaLabel.length > 9)")


CONTRAST = """
(() => {
  const parts = c => c.match(/[\\d.]+/g).map(Number);
  const light = c => {
    const [r, g, b] = parts(c).map(x => x / 255)
      .map(x => x <= 0.04045 ? x / 12.92 : ((x + 0.055) / 1.055) ** 2.4);
    return 0.2126 * r + 0.7152 * g + 0.0722 * b;
  };
  const ground = e => {
    for (; e; e = e.parentElement) {
      const c = parts(getComputedStyle(e).backgroundColor);
      if (c.length < 4 || c[3] > 0) return light(getComputedStyle(e).backgroundColor);
    }
    return 1;
  };
  return Math.min(...[...document.querySelectorAll('h1,h2,h3,p,td,th,dt,dd,li,caption,summary,'
    + 'label,figcaption')].map(e => {
      const [a, b] = [light(getComputedStyle(e).color), ground(e)];
      return (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
  }));
})()
"""
"""Least contrast of any text against its ground, by the formula of WCAG 2."""


@needs_browser
@pytest.mark.parametrize("dark", [False, True])
def test_contrast_is_4_5_to_1_or_better(browser, page, dark):
    browser.open(page, dark=dark)
    assert browser.ask(CONTRAST) >= 4.5


def axes_of(sheet, name):
    return sheet.figure(name).axes[0]


def test_the_points_are_the_pads_of_the_stops(found):
    ax = axes_of(sheet(found.table, found.results), "pads")
    points = {c.get_label(): c[0].get_xydata()[:, 1] for c in ax.containers}
    assert np.allclose(points["front, stop"], [r.figures["pad_friction_f"] for r in found.results])
    assert np.allclose(points["rear, stop"], [r.figures["pad_friction_r"] for r in found.results])


def test_a_name_with_a_dollar_is_drawn_as_text(found):
    ax = axes_of(sheet(found.table, found.results), "stop-1")
    assert ax.get_title(loc="left").count(r"\$") == 1

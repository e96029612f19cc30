"""The report of a car, read as text and opened in a real browser."""

import re
from dataclasses import replace
from html.parser import HTMLParser
from itertools import pairwise

import pytest

from calib.show.html import page_of
from calib.show.station_page import StationRun, facts
from tests.support.browser import ask, needs_browser, opened
from tests.support.station_run import MARKUP


@pytest.fixture(scope="module")
def html(found, kept):
    car = replace(found.table.vehicle, name=f"car {MARKUP}")
    return page_of(facts(StationRun(replace(found, table=replace(found.table, vehicle=car)), kept)))


@pytest.fixture(scope="module")
def page(html, tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(html)
    return path


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
    assert len(images) == 4  # the second panel of a figure is told with the first
    assert sum(len(image["alt"]) > 40 for image in images) == 3
    assert seen.tags.count("table") == seen.tags.count("caption")
    assert dict(seen.attributes)["html"] == {"lang": "en"}
    levels = [int(tag[1]) for tag in seen.tags if re.fullmatch("h[1-6]", tag)]
    assert levels[0] == 1
    assert all(b - a <= 1 for a, b in pairwise(levels))


def test_the_verdict_comes_first_and_each_failure_has_a_next_step(html, found):
    texts = [text.strip() for text in read(html).texts if text.strip()]
    assert texts.index("Failed") < texts.index("Metrics")
    for check in found.with_verdict("failed"):
        assert any(check.text in text for text in texts)


@needs_browser
@pytest.mark.parametrize(("width", "dark"), [(1000, True), (360, False)])
def test_opens_quietly_and_fits_the_screen(browser, page, width, dark):
    assert opened(browser, page, width, dark) == ([], [])
    assert ask(browser, "document.documentElement.scrollWidth") <= width
    size = "[i.complete, i.naturalWidth, i.clientWidth, i.clientHeight]"
    sizes = ask(browser, f"[...document.images].map(i => {size})")
    assert len(sizes) == 4  # f1 and f2, the map, and the pads of two stops
    assert all(done and wide > 300 and w > 300 and h > 100 for done, wide, w, h in sizes)


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
    opened(browser, page, dark=dark)
    assert ask(browser, CONTRAST) >= 4.5

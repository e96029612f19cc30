"""The report of a car, read as text and opened in a real browser."""

from dataclasses import replace

import pytest

from calib.show.html import page_of
from calib.show.station_page import StationRun, station_facts
from tests.support.browser import ask, needs_browser, opened
from tests.support.station_run import MARKUP


@pytest.fixture(scope="module")
def html(outcome, stored):
    car = replace(outcome.table.vehicle, name=f"car {MARKUP}")
    return page_of(
        station_facts(
            StationRun(replace(outcome, table=replace(outcome.table, vehicle=car)), stored)
        )
    )


@pytest.fixture(scope="module")
def page(html, tmp_path_factory):
    path = tmp_path_factory.mktemp("report") / "report.html"
    path.write_text(html)
    return path


@needs_browser
@pytest.mark.parametrize(("width", "dark"), [(1000, True), (360, False)])
def test_opens_quietly_and_fits_the_screen(browser, page, width, dark):
    assert opened(browser, page, width, dark) == ([], [])
    assert ask(browser, "document.documentElement.scrollWidth") <= width
    size = "[i.complete, i.naturalWidth, i.clientWidth, i.clientHeight]"
    sizes = ask(browser, f"[...document.images].map(i => {size})")
    assert len(sizes) == 6  # f1 and f2, the map, and torque and pads of two stops
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

"""Facts on a terminal and on a page: all texts are shown, and no markup in them has an effect."""

import io
import re
from html.parser import HTMLParser
from urllib.parse import unquote

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from calib.base.warning import PlausibilityWarning
from calib.show.facts import Facts, Picture, Table
from calib.show.html import _panel, is_page, page_of
from calib.show.panel import Line, Panel
from calib.show.sheet import Sheet
from cli.console import begin_run, print_result, this_run

EMPTY = Sheet("made", "made", (Panel("a", "a", "x [1]", "y [1]", ()),))


class Reader(HTMLParser):
    def __init__(self, html):
        super().__init__()
        self.tags, self.texts, self.values = [], [], []
        self.feed(html)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        self.values += [value for _, value in attrs if value]

    def handle_data(self, data):
        self.texts.append(data)


def full(text):
    """Facts whose every text is ``text``."""
    table = Table((text, text), [(text, text)], text, ["failed"], ["run/report.html"])
    warning = PlausibilityWarning(text, text, 1.0, (0.0, None), (text,), text)
    part = Facts(text, headline=text, tables=[table])
    return Facts(
        text,
        headline=text,
        verdict="warning",
        word=text,
        numbers=[(text, text)],
        rows=[(text, text)],
        tables=[table],
        notes=[text],
        next=text,
        warnings=[warning],
        pictures=[Picture(text, lambda: EMPTY)],
        parts=[part],
    )


@pytest.fixture(autouse=True)
def without_pictures(monkeypatch):
    monkeypatch.setattr("calib.show.html._panel", lambda sheet, name: "data:,")


# without carriage return and nul, which a reader of HTML may not hand back
TEXT = st.text(st.characters(codec="utf-8", exclude_characters="\r\0"), min_size=1)


@settings(suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(text=TEXT | st.sampled_from(["<script>", "</title>", '"><b>', "&amp;", "<!--", "'", "{{"]))
def test_a_page_shows_every_text_as_it_was_and_fetches_nothing(text):
    html = page_of(full(text))
    plain_page, page = Reader(page_of(full("x"))), Reader(html)
    assert is_page(html.encode())
    assert page.tags == plain_page.tags
    assert "".join(page.texts).count(text) >= 24
    assert page.values.count(text) >= 3  # labels of tables and pictures, read aloud
    assert {"script", "iframe"}.isdisjoint(page.tags)
    assert not [x for x in plain_page.values if "//" in x or x.startswith("/")]


def test_a_part_without_content_is_not_shown_and_a_live_page_loads_itself_again():
    empty = Facts("all", parts=[Facts("nothing", tables=[Table(("a",), [])])])
    assert "nothing" not in page_of(empty)
    assert "refresh" not in page_of(empty)
    assert "refresh" in page_of(empty, again=10)


def printed(facts, *, quiet=False, verbose=False):
    out = io.StringIO()
    begin_run()
    this_run().quiet, this_run().verbose = quiet, verbose
    print_result(facts, out)
    begin_run()
    return out.getvalue()


def test_a_terminal_prints_the_answer_last_and_no_control_codes():
    """The head has 13 texts: word, headline, a table of 5, 2 rows of 2, a note, the next step."""
    facts = full("\x1b[31m[b]x")
    usual, quiet, verbose = printed(facts), printed(facts, quiet=True), printed(facts, verbose=True)
    assert "\x1b" not in verbose
    assert [text.count("[b]x") for text in (quiet, usual, verbose)] == [2, 13, 20]
    assert usual.startswith(quiet)
    assert verbose.endswith(usual)


@pytest.mark.parametrize("width", [40, 60, 200])
def test_a_table_that_is_too_wide_becomes_blocks_and_numbers_stay_whole(width, monkeypatch):
    monkeypatch.setenv("COLUMNS", str(width))
    cells = [(f"stop_{i}_on_a_wet_road", "0.381\xa0±\xa00.026", "95.2\xa0%") for i in range(2)]
    text = printed(Facts(tables=[Table(("stop", "front pads", "valid"), cells)]))
    assert all(text.count(cell) == 1 + (cell is not name) for name, *more in cells for cell in more)
    assert max(map(len, text.splitlines())) <= width
    assert text.count("front pads") == (2 if width == 40 else 1)


def test_a_line_of_a_panel_keeps_its_gap_and_its_places():
    x = np.linspace(0.0, 1.0, 101)
    y = np.where(abs(x - 0.5) < 0.1, np.nan, np.sin(9.0 * x))
    look = {"color": "#123456"}
    panel = Panel("one", "One", "x", "y", [Line(x, y, look)], ylim=(-1.0, 1.0), xlim=(0.0, 1.0))
    svg = unquote(_panel(Sheet("test", "test", (panel,)), "one"))
    (path,) = re.findall(r"<path d='([^']*)'[^>]*#123456", svg)
    parts = [re.findall(r"-?[\d.]+", part) for part in path.split("M")[1:]]
    places = [np.cumsum(np.reshape(np.array(part, float), (-1, 2)), axis=0) for part in parts]
    left, right = places  # of the gap
    width = right[-1, 0] - left[0, 0]  # from x = 0 to x = 1
    gap = np.array([left[-1, 0], right[0, 0]]) - left[0, 0]
    assert gap / width == pytest.approx([0.4, 0.6], abs=0.011)

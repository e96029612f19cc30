"""Facts on a terminal and on a page: all texts come back, and none of them is obeyed."""

import io
from html.parser import HTMLParser

import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.warning import PlausibilityWarning
from calib.show.facts import Facts, Picture, Table
from calib.show.html import is_page, page_of
from cli.console import emit

SVG = b"<svg/>"


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


def full(text, folded=False):
    """Facts whose every text is ``text``."""
    table = Table((text, text), [(text, text)], text, ["failed"], ["run/report.html"])
    warning = PlausibilityWarning(text, text, 1.0, (0.0, None), (text,), text)
    part = Facts(text, headline=text, tables=[table], folded=folded)
    return Facts(
        text,
        headline=text,
        verdict="warning",
        word=text,
        numbers=[(text, text)],
        rows=[(text, text)],
        tables=[table],
        notes=[text],
        warnings=[warning],
        pictures=[Picture(text, SVG)],
        parts=[part],
    )


# without carriage return and nul, which a reader of HTML may not hand back
TEXT = st.text(st.characters(codec="utf-8", exclude_characters="\r\0"), min_size=1)


@pytest.mark.parametrize("folded", [False, True])
@given(text=TEXT | st.sampled_from(["<script>", "</title>", '"><b>', "&amp;", "<!--", "'", "{{"]))
def test_a_page_shows_every_text_as_it_was_and_fetches_nothing(folded, text):
    html = page_of(full(text, folded))
    plain, found = Reader(page_of(full("x", folded))), Reader(html)
    assert is_page(html.encode())
    assert found.tags == plain.tags
    assert "".join(found.texts).count(text) >= 23
    assert found.values.count(text) >= 3  # labels of tables and pictures, read aloud
    assert {"script", "iframe"}.isdisjoint(found.tags)
    assert not [v for v in plain.values if "//" in v or v.startswith("/")]


def test_a_part_without_content_is_not_shown_and_a_live_page_loads_itself_again():
    empty = Facts("all", parts=[Facts("nothing", tables=[Table(("a",), [])])])
    assert "nothing" not in page_of(empty)
    assert "http-equiv" not in page_of(empty)
    assert "http-equiv" in page_of(empty, again=10)


def test_a_terminal_prints_the_verdict_last_and_obeys_nothing():
    out = io.StringIO()
    emit(full("\x1b[31m[b]x"), out)
    text = out.getvalue()
    assert "\x1b" not in text
    assert text.count("[b]x") == 19
    assert text.rstrip().rsplit("\n", 1)[1].count("[b]x") == 2

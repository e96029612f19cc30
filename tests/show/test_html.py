"""Parts of a page: whatever is handed over comes out as text."""

from html.parser import HTMLParser

import pytest
from hypothesis import given
from hypothesis import strategies as st
from jinja2 import UndefinedError

from calib.show.html import Picture, environment, is_page, page, picture


class Reader(HTMLParser):
    def __init__(self, html):
        super().__init__()
        self.tags, self.texts, self.values = set(), [], []
        self.feed(html)
        self.close()

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.values += [value for _, value in attrs]

    def handle_data(self, data):
        self.texts.append(data)


def rendered(source, **view):
    """The page whose main part is ``source``, which knows every macro as parts.NAME."""
    whole = (
        '{% extends "base.html.j2" %}{% import "parts.html.j2" as parts %}'
        "{% block main %}" + source + "{% endblock %}"
    )
    return Reader(environment().from_string(whole).render(view))


PARTS = [
    "<p>{{ text }}</p>",
    "{{ parts.listing([text]) }}",
    "{{ parts.terms([(text, text)]) }}",
    "{{ parts.key_numbers([(text, text)]) }}",
    "{{ parts.table(text, (text, text), [(text, text)], text, [text]) }}",
    "{% call parts.folded(text) %}<p>{{ text }}</p>{% endcall %}",
    "{{ parts.figure(picture, text, text) }}",
]

# without carriage return and nul, which a reader of HTML may not hand back
TEXT = st.text(st.characters(codec="utf-8", exclude_characters="\r\0"), min_size=1)


@pytest.mark.parametrize("part", PARTS)
@given(text=TEXT | st.sampled_from(["<script>", "</title>", '"><b>', "&amp;", "<!--", "'", "{{"]))
def test_text_comes_back_from_every_part_as_it_was(part, text):
    reader = rendered(part, title="", text=text, picture=Picture("data:,", "box"))
    assert text in "".join(reader.texts)
    assert reader.tags <= {
        "html", "head", "meta", "link", "title", "style", "body", "main", "p", "ul", "li", "dl",
        "dt", "dd", "div", "table", "caption", "thead", "tbody", "tr", "th", "td", "details",
        "summary", "figure", "input", "label", "img", "figcaption",
    }  # fmt: skip


def test_what_a_picture_shows_and_a_table_holds_is_read_aloud_as_it_was():
    text = '"><b onclick=x>&amp;'
    source = PARTS[-1] + "{{ parts.table(text, [], []) }}"
    reader = rendered(source, title="", text=text, picture=Picture("data:,", "box"))
    assert reader.values.count(text) == 3  # alt, and the label of the picture and of the table
    assert "onclick" not in reader.values


def test_only_a_picture_with_a_key_can_be_enlarged():
    fixed, larger = (
        rendered(PARTS[-1], title="", text="x", picture=picture(b"a", "png", key))
        for key in ("", "box")
    )
    assert "data:image/png;base64,YQ==" in fixed.values
    assert "input" not in fixed.tags
    assert "input" in larger.tags


def test_a_page_names_its_language_and_fetches_nothing():
    reader = rendered("<p>x</p>", title="<b>")
    assert "en" in reader.values
    assert {"script", "iframe", "b"} & reader.tags == set()
    assert [v for v in reader.values if v and ("//" in v or v.startswith("/"))] == []


def test_a_value_that_is_not_given_is_an_error_and_no_hole_in_the_page():
    with pytest.raises(UndefinedError, match="title"):
        page("report")


def test_a_page_is_known_as_one_and_no_other():
    made = environment().from_string('{% extends "base.html.j2" %}').render(title="x" * 5000)
    assert is_page(made.encode())
    assert not is_page(b"<!DOCTYPE html><html><title>brake-cal</title>")

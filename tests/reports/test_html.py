"""Parts of a page: whatever is handed over comes out as text."""

from html.parser import HTMLParser

from hypothesis import given
from hypothesis import strategies as st

from calib.reports.html import folded, listing, page, paragraph, section, table, terms


class Reader(HTMLParser):
    def __init__(self):
        super().__init__()
        self.tags, self.texts, self.values = set(), [], []

    def handle_starttag(self, tag, attrs):
        self.tags.add(tag)
        self.values += [value for _, value in attrs]

    def handle_data(self, data):
        self.texts.append(data)


# without carriage return and nul, which a reader of HTML may not hand back
TEXT = st.text(st.characters(codec="utf-8", exclude_characters="\r\0"), min_size=1)


@given(text=TEXT | st.sampled_from(["<script>", "</title>", '"><b>', "&amp;", "<!--", "'"]))
def test_text_comes_back_from_every_part_as_it_was(text):
    parts = [
        section(text, paragraph(text)),
        listing([text]),
        terms([(text, text)]),
        table(text, (text, text), [(text, text)]),
        folded(text, paragraph(text)),
    ]
    for part in parts:
        reader = Reader()
        reader.feed(part)
        reader.close()
        assert text in "".join(reader.texts)
        assert reader.tags <= {
            "section", "h2", "p", "ul", "li", "dl", "dt", "dd", "div", "table", "caption", "thead",
            "tbody", "tr", "th", "td", "details", "summary",
        }  # fmt: skip


def test_a_page_names_its_language_and_fetches_nothing():
    reader = Reader()
    reader.feed(page("<b>", ["", paragraph("x")]))
    assert "en" in reader.values
    assert {"script", "iframe", "b"} & reader.tags == set()
    assert [v for v in reader.values if v and ("//" in v or v.startswith("/"))] == []


def test_what_is_empty_leaves_nothing():
    assert paragraph("") == listing([]) == terms([]) == ""

"""Markdown of a page as HTML."""

import pytest
from lxml import html

from calib.manual.html import anchor, body

PAGE = """# A page

See [limits](line.md#limits), [minisign](https://a.b) and [here](#a-part-again).

## A part, again

| | value |
|---|---|
| `mass` | 3 \\| 4 & <b> |

## A part, again

```sh
brake-cal fit <log>
```

![a table](../../sample_logs/figures/table.png)
"""


@pytest.fixture(scope="module")
def made():
    return body(PAGE)


@pytest.fixture(scope="module")
def tree(made):
    return html.fromstring(f"<div>{made.html}</div>")


def test_headings_have_the_anchors_of_github(tree, made):
    assert [h.get("id") for h in tree.iter("h1", "h2")] == [
        "a-page",
        "a-part-again",
        "a-part-again-1",
    ]
    assert [part.anchor for part in made.sections] == ["a-page", "a-part-again", "a-part-again-1"]
    assert anchor("What an error of 10 % does") == "what-an-error-of-10--does"


def test_links_lead_to_the_pages_of_the_site(tree):
    assert [a.get("href") for a in tree.iter("a")] == [
        "line.html#limits",
        "https://a.b",
        "#a-part-again",
    ]


def test_tables_scroll_and_an_empty_head_is_no_head(tree):
    (box,) = tree.xpath("//table/..")
    assert (box.get("class"), box.get("tabindex")) == ("wide", "0")
    assert [cell.tag for cell in tree.xpath("//thead/tr/*")] == ["td", "th"]
    assert tree.xpath("//tbody//td")[1].text == "3 | 4 & <b>"


def test_code_is_text(tree):
    assert tree.xpath("//pre/code")[0].text == "brake-cal fit <log>\n"


def test_pictures_are_those_of_the_site(tree, made):
    (picture,) = tree.iter("img")
    assert (picture.get("src"), picture.get("alt")) == ("figures/table.png", "a table")
    assert made.pictures == ("../../sample_logs/figures/table.png",)


def test_sections_have_the_words_without_marks(made):
    assert [part.title for part in made.sections] == ["A page", "A part, again", "A part, again"]
    assert made.sections[0].text == "See limits, minisign and here."
    assert made.sections[1].text == "value mass 3 | 4 & <b>"

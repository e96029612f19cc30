"""The manual as a site: every link leads somewhere, and in a browser it is searched and read."""

import json
import re
from pathlib import Path

import pytest
from lxml import html

from calib.manual.page import contents
from calib.manual.site import START, site
from tests.support.browser import BROWSER, Browser

WIDTHS = "document.documentElement.scrollWidth + ' ' + document.documentElement.clientWidth"
CONTRAST = """
(() => {
  const channel = (c) => (c /= 255) <= 0.03928 ? c / 12.92 : ((c + 0.055) / 1.055) ** 2.4;
  const light = ([r, g, b]) =>
    0.2126 * channel(r) + 0.7152 * channel(g) + 0.0722 * channel(b);
  const numbers = (colour) => colour.match(/[\\d.]+/g).map(Number);
  const ground = (node) => {
    for (let at = node; at; at = at.parentElement) {
      const found = numbers(getComputedStyle(at).backgroundColor);
      if (found.length === 3 || found[3] > 0) return found;
    }
    return [255, 255, 255];
  };
  const low = [];
  for (const node of document.querySelectorAll("p, a, li, td, th, h1, h2, h3, code, label, span")) {
    const a = light(numbers(getComputedStyle(node).color)), b = light(ground(node));
    const ratio = (Math.max(a, b) + 0.05) / (Math.min(a, b) + 0.05);
    if (ratio < 4.5) low.push(node.outerHTML.slice(0, 80) + " " + ratio.toFixed(2));
  }
  return low;
})()
"""


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    out = tmp_path_factory.mktemp("manual")
    for name, content in site().items():
        (out / name).parent.mkdir(exist_ok=True)
        (out / name).write_bytes(content)
    return out


def pages(folder: Path) -> list[Path]:
    return sorted(folder.glob("*.html"))


def test_there_is_a_file_for_every_page(folder):
    names = {page.name for page in pages(folder)}
    assert names == {START, *(f"{page.name}.html" for page in contents())}


def test_every_link_and_picture_leads_to_something_in_the_folder(folder):
    trees = {page.name: html.fromstring(page.read_bytes()) for page in pages(folder)}
    for name, tree in trees.items():
        for element, _, target, _ in tree.iterlinks():
            if target.startswith(("https://", "data:")):
                assert element.tag in ("a", "link"), target
                continue
            path, _, at = target.partition("#")
            assert (folder / (path or name)).is_file(), f"{name}: {target}"
            if at:
                assert trees[path or name].get_element_by_id(at, None) is not None, target


def test_a_page_has_landmarks_a_language_and_one_title(folder):
    for page in pages(folder):
        tree = html.fromstring(page.read_bytes())
        assert tree.get("lang") == "en"
        for one in ("main", "nav", "body/header", "main//h1"):
            assert len(tree.xpath(f"//{one}")) == 1, (page.name, one)
        (skip,) = tree.xpath("//a[@class='skip']")
        assert tree.get_element_by_id(skip.get("href")[1:]).tag == "main"
        assert all(picture.get("alt") for picture in tree.iter("img"))
        levels = [int(heading.tag[1]) for heading in tree.xpath("//main//*[self::h1 or self::h2]")]
        assert levels[0] == 1


def test_the_search_knows_every_section(folder):
    script = (folder / "search.js").read_text()
    (line,) = re.findall(r"^const SECTIONS = (.*);$", script, flags=re.MULTILINE)
    entries = json.loads(line.replace("<\\/", "</"))
    assert {entry["at"].split("#")[0] for entry in entries} == {
        f"{page.name}.html" for page in contents()
    }
    for entry in entries:
        page, at = entry["at"].split("#")
        assert html.fromstring((folder / page).read_bytes()).get_element_by_id(at) is not None


@pytest.fixture(scope="module")
def browser(tmp_path_factory: pytest.TempPathFactory):
    if BROWSER is None:
        pytest.skip("no chromium here")
    with Browser(tmp_path_factory.mktemp("profile")) as one:
        yield one


def test_pages_fetch_their_own_files_only_and_fit_a_phone(folder, browser):
    own = {page.as_uri() for page in folder.rglob("*")}
    for page in pages(folder):
        seen = browser.open(page, width=360)
        assert set(seen.requests) <= own
        assert seen.complaints == [], page.name
        whole, shown = browser.ask(WIDTHS).split()
        assert int(whole) <= int(shown), page.name


@pytest.mark.parametrize("dark", [False, True])
def test_text_can_be_read_on_light_and_on_dark(folder, browser, dark):
    for name in ("index", "warnings", "line"):
        browser.open(folder / f"{name}.html", dark=dark)
        assert browser.ask(CONTRAST) == [], name
    colour = browser.ask("getComputedStyle(document.body).backgroundColor")
    assert (colour == "rgb(255, 255, 255)") is not dark


def test_the_search_finds_a_section_and_leads_to_it(folder, browser):
    browser.open(folder / START)
    type_words = "(() => {{ const i = document.getElementById('words'); i.value = '{}'; "
    type_words += "i.dispatchEvent(new Event('input')); "
    type_words += "return document.getElementById('count').textContent; }})()"
    assert browser.ask(type_words.format("xyzzy")) == "0 sections found"
    assert re.match(r"\d+ sections found", browser.ask(type_words.format("Golden TABLE")))
    first = browser.ask("document.querySelector('#found a').getAttribute('href')")
    assert first == "line.html#a-golden-table"
    marked = browser.ask("document.querySelector('#found mark').textContent.toLowerCase()")
    assert marked in ("golden", "table")
    assert browser.ask(type_words.format("")) == ""
    assert browser.ask("document.querySelectorAll('#found li').length") == 0


def test_on_paper_is_the_text_alone(folder, browser):
    browser.open(folder / "line.html")
    browser.call("Emulation.setEmulatedMedia", media="print", features=[])
    shown = "['form', 'nav', 'main'].map(x => document.querySelector(x).checkVisibility())"
    assert browser.ask(shown) == [False, False, True]
    browser.call("Emulation.setEmulatedMedia", media="", features=[])

import json
from html.parser import HTMLParser

import pytest

from calib.line.fleet.outliers import SHARE, judge
from calib.line.fleet.results import open_fleet
from calib.line.fleet.summary import summarise
from calib.show.fleet_figure import sheet
from calib.show.fleet_page import document, headline, number, reach, reason, report_html
from calib.show.html import Picture, drawn
from cli.console import plain
from tests.support.fleet_results import results


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return summarise(open_fleet(results(tmp_path_factory.mktemp("fleet") / "r.parquet")))


class Page(HTMLParser):
    def __init__(self, text):
        super().__init__()
        self.tags, self.sources, self.alts, self.text = [], [], [], []
        self.feed(text)

    def handle_starttag(self, tag, attrs):
        self.tags.append(tag)
        told = dict(attrs)
        self.sources += [told[key] for key in ("src", "href") if key in told]
        if tag == "img":
            self.alts.append(told.get("alt", ""))

    def handle_data(self, data):
        self.text.append(data)


def test_the_page_fetches_nothing_and_escapes_everything(found):
    picture = drawn(sheet(found, found.looks[0]), "distribution", "order")
    text = report_html(found, "<i>a & b</i>", {one.metric.name: picture for one in found.looks})
    page = Page(text)
    assert "b" not in page.tags
    assert "i" not in page.tags
    assert "script" not in page.tags
    assert any("csv: <b>ends</b> at " in text for text in page.text)
    assert len(page.alts) == 6  # two panels of each metric; the first has the text of both
    assert sum(bool(alt) for alt in page.alts) == 3
    assert all(source.startswith("data:") for source in page.sources)
    assert sum(source.startswith("data:image/svg+xml;base64,") for source in page.sources) == 6


def test_the_headline_names_what_drifts(found):
    assert headline(found).startswith("Pad friction, front, built drift; ")
    assert "3 logs with an error" in headline(found)


def test_the_document_is_json_and_says_what_chance_gives(found):
    told = json.loads(json.dumps(plain(document(found)), allow_nan=False))
    assert told["status"] == {"passed": 397, "error": 3}
    pads = told["figures"]["pad_friction_f"]
    assert pads["change"]["drifts"] is True
    assert pads["chart"]["rules"]["1"]["by_chance"] == pytest.approx(0.0027 * 397)
    assert told["outliers_by_chance"] == pytest.approx(SHARE * len(told["outliers"]))
    low, high = pads["named_beyond"]
    assert low < pads["quantiles"]["5"]
    assert pads["quantiles"]["95"] < high < told["outliers"][0]["value"]
    assert told["outliers"][0]["log"] == "line/car134.csv"
    assert list(told["outliers"][0]) == ["log", "figure", "value", "z", "p"]


def test_a_short_line_is_not_called_steady_and_has_no_counts_by_chance(tmp_path):
    short = summarise(open_fleet(results(tmp_path / "r.parquet", 15)), ("settling",))
    assert headline(short) == "Drift not tested; no log stands apart."
    page = report_html(short, "t", {"settling": Picture("data:,")})
    assert '<header class="unknown">' in page
    assert ">not tested</td>" in page
    told = document(short)["figures"]["settling"]
    assert told["change"] is None
    assert told["chart"]["rules"]["1"]["by_chance"] is None


def test_numbers_show_their_scatter():
    import numpy as np

    eta = 1.003 + 1e-5 * np.linspace(-1.0, 1.0, 21)
    assert number(1.0030052, judge(eta[None]).spreads[0]) == "1.003005"
    assert number(0.38123, judge(np.linspace(0.3, 0.5, 9)[None]).spreads[0]) == "0.3812"


def test_a_few_logs_are_not_called_steady(tmp_path):
    few = summarise(open_fleet(results(tmp_path / "r.parquet", 3)))
    assert headline(few) == "3 logs: too few to judge outliers or drift."
    page = report_html(few, "t", {one.metric.name: Picture("data:,") for one in few.looks})
    assert '<header class="unknown">' in page


def test_a_car_is_told_once_in_plain_names_and_units(found):
    (car,) = found.apart
    assert car.log == "line/car134.csv"
    text = reason(found, car.reasons[0])
    assert text.startswith("Pad friction, front 0.550: above the others, 90 % of them from 0.3")
    assert document(found)["apart"] == [{"log": car.log, "p": car.p, "figures": ["pad_friction_f"]}]


def test_the_page_says_what_so_few_logs_can_show(tmp_path, found):
    few = summarise(open_fleet(results(tmp_path / "r.parquet", 12)), ("settling",))
    picture = Picture("data:,")
    told = reach(few)
    assert told.startswith("Among 12 logs only one that is far away can be told apart: ")
    assert told in " ".join(Page(report_html(few, "t", {"settling": picture})).text)
    assert reach(summarise(open_fleet(results(tmp_path / "s.parquet", 3)))) == ""

    def times(text):
        return float(text.split("apart: ")[1].split(" times")[0])

    assert times(told) > times(reach(found)) > 3.0

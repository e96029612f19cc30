import json
from dataclasses import replace

import pytest

from calib.line.fleet.outliers import SHARE
from calib.line.fleet.results import open_fleet
from calib.line.fleet.summary import document, headline, summarise
from calib.show.fleet_page import facts
from calib.show.html import page_of
from cli.console import plain
from tests.support.fleet_results import results


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return summarise(open_fleet(results(tmp_path_factory.mktemp("fleet") / "r.parquet")))


def test_the_page_has_a_part_with_pictures_for_each_metric(found):
    told = replace(facts(found), title="<i>a & b</i>")
    metrics = [metric for part in told.parts for metric in part.parts]
    assert len(metrics) == 3
    text = page_of(told)
    assert text.count("image/svg+xml") == 3
    assert "csv: &lt;b&gt;ends&lt;/b&gt; at " in text


def test_the_headline_names_what_drifts(found):
    assert headline(found).startswith("Pad friction, front, built drift; ")
    assert "3 logs with an error" in headline(found)


def test_the_document_is_json_and_says_what_chance_gives(found):
    told = json.loads(json.dumps(plain(document(found)), allow_nan=False))
    assert told["status"] == {"passed": 397, "error": 3}
    pads = told["figures"]["pad_friction_f"]
    assert pads["change"]["drifts"] is True
    assert told["outliers_by_chance"] == pytest.approx(SHARE * len(told["outliers"]))
    assert pads["quantiles"]["95"] < told["outliers"][0]["value"]
    assert told["outliers"][0]["log"] == "line/car134.csv"
    assert list(told["outliers"][0]) == ["log", "figure", "value", "z", "p"]


def test_a_short_line_is_not_called_steady(tmp_path):
    short = summarise(open_fleet(results(tmp_path / "r.parquet", 15)), ("settling",))
    assert headline(short) == "Drift not tested; no log stands apart."
    page = facts(short)
    assert page.verdict == "unjudged"
    assert page.parts[2].tables[0].rows[0][-1] == "not tested"
    told = document(short)["figures"]["settling"]
    assert told["change"] is None

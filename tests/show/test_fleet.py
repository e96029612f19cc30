import json

import numpy as np
import pyarrow as pa
import pytest

from calib.line.fleet.results import open_fleet
from calib.line.fleet.summary import document, summarise
from calib.show.fleet import fleet_facts, metric_sheet, window
from calib.show.sheet import render
from cli.console import plain
from tests.support.fleet_results import results
from tests.support.plot_lines import labels, line, panel


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return summarise(open_fleet(results(tmp_path_factory.mktemp("fleet") / "r.parquet")))


def test_every_log_is_a_point_and_the_far_one_a_mark_at_the_edge(found):
    pads, calm = found.metrics[:2]
    order = panel(metric_sheet(found, pads), "order")
    low, high = window(pads)
    assert np.array_equal(order.lines[0].x, pads.rows + 1)
    assert np.array_equal(order.lines[0].y, np.clip(pads.values, low, high))
    x, y = line(order, "stands apart")
    assert 134 in x
    assert max(y) == high < 0.55
    assert ("car134", 134.0, high) in order.texts
    assert line(order, "level")[1].tolist() == [pads.change.old_level] * 2
    assert "level" not in labels(panel(metric_sheet(found, calm), "order"))


@pytest.mark.parametrize("n", [1, 3, 12])
def test_small_fleets_are_drawn_and_names_as_they_are(tmp_path, n):
    odd = {"a$b/c$": ([float(i) for i in range(n)], pa.float64(), "1")}
    few = summarise(open_fleet(results(tmp_path / "r.parquet", n, extra=odd)))
    for look in few.metrics:
        low, high = window(look)
        assert n >= 10 or (low <= look.values.min() and look.values.max() <= high)
        assert render(metric_sheet(few, look).overview(), ".png").startswith(b"\x89PNG")
    assert "a$b/c$" in [metric_sheet(few, look).panels[0].title for look in few.metrics]


def test_the_document_is_json(found):
    told = json.loads(json.dumps(plain(document(found)), allow_nan=False))
    assert told["status"] == {"passed": 397, "error": 3}
    pads, worst = told["figures"]["pad_friction_f"], told["outliers"][0]
    assert pads["change"]["drifts"] is True
    assert told["outliers_by_chance"] == pytest.approx(0.03 * len(told["outliers"]))
    assert told["apart"][0]["log"] == worst["log"] == "line/car134.csv"
    assert list(worst) == ["log", "figure", "value", "z", "p"]
    assert pads["quantiles"]["95"] < worst["value"]
    assert worst["z"] > 4.0


def test_a_short_line_is_not_called_steady(tmp_path):
    short = summarise(open_fleet(results(tmp_path / "r.parquet", 15)))
    assert short.headline == "Drift not tested; no log stands apart."
    page = fleet_facts(short)
    assert page.verdict == "unjudged"
    assert page.parts[2].tables[0].rows[0][-1] == "not tested"
    assert document(short)["figures"]["settling"]["change"] is None

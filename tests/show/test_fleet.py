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
def summary(tmp_path_factory):
    return summarise(open_fleet(results(tmp_path_factory.mktemp("fleet") / "r.parquet")))


def test_every_log_is_a_point_and_the_far_one_a_mark_at_the_edge(summary):
    pads, calm = summary.metrics[:2]
    order = panel(metric_sheet(summary, pads), "order")
    low, high = window(pads)
    assert np.array_equal(order.lines[0].x, pads.rows + 1)
    assert np.array_equal(order.lines[0].y, np.clip(pads.values, low, high))
    x, y = line(order, "stands apart")
    assert 134 in x
    assert max(y) == high < 0.55
    assert ("car134", 134.0, high) in order.texts
    assert "stands apart" not in labels(panel(metric_sheet(summary, calm), "order"))


@pytest.mark.parametrize("n", [1, 3, 12])
def test_small_fleets_are_drawn_with_names_as_written(tmp_path, n):
    odd = {"a$b/c$": ([float(i) for i in range(n)], pa.float64(), "1")}
    small = summarise(open_fleet(results(tmp_path / "r.parquet", n, extra=odd)))
    for metric in small.metrics:
        low, high = window(metric)
        assert n >= 10 or (low <= metric.values.min() and metric.values.max() <= high)
        assert render(metric_sheet(small, metric).overview(), ".png").startswith(b"\x89PNG")
    assert "a$b/c$" in [metric_sheet(small, metric).panels[0].title for metric in small.metrics]


def test_fleet_json_has_the_keys_that_scripts_read(summary):
    content = json.loads(json.dumps(plain(document(summary)), allow_nan=False))
    pads, outlier = content["figures"]["pad_friction_f"], content["outliers"][0]
    assert content["status"] == {"passed": 397, "error": 3}
    assert (outlier["log"], outlier["figure"]) == ("line/car134.csv", "pad_friction_f")
    assert pads["quantiles"]["95"] < outlier["value"]
    assert outlier["p"] < 1e-4
    assert pads["outliers"] >= 1


def test_a_fleet_is_green_only_where_it_was_judged(tmp_path):
    for n, verdict in ((5, "unjudged"), (20, "passed"), (400, "warning")):
        of_n_logs = summarise(open_fleet(results(tmp_path / f"{n}.parquet", n)))
        assert fleet_facts(of_n_logs).verdict == verdict

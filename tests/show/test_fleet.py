import numpy as np
import pyarrow as pa
import pytest

from calib.line.fleet.results import open_fleet
from calib.line.fleet.summary import summarise
from calib.show.fleet import fleet_facts, metric_sheet, window
from calib.show.sheet import render
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
    assert "stands apart" not in labels(panel(metric_sheet(found, calm), "order"))


@pytest.mark.parametrize("n", [1, 3, 12])
def test_small_fleets_are_drawn_and_names_as_they_are(tmp_path, n):
    odd = {"a$b/c$": ([float(i) for i in range(n)], pa.float64(), "1")}
    few = summarise(open_fleet(results(tmp_path / "r.parquet", n, extra=odd)))
    for look in few.metrics:
        low, high = window(look)
        assert n >= 10 or (low <= look.values.min() and look.values.max() <= high)
        assert render(metric_sheet(few, look).overview(), ".png").startswith(b"\x89PNG")
    assert "a$b/c$" in [metric_sheet(few, look).panels[0].title for look in few.metrics]


def test_a_fleet_is_green_only_where_it_was_judged(tmp_path):
    few, steady, apart = (
        fleet_facts(summarise(open_fleet(results(tmp_path / f"{n}.parquet", n))))
        for n in (5, 20, 400)
    )
    assert [facts.verdict for facts in (few, steady, apart)] == ["unjudged", "passed", "warning"]

import numpy as np
import pytest

from calib.line.fleet.results import open_fleet
from calib.line.fleet.summary import summarise
from calib.show.fleet_figure import sheet, window
from calib.show.sheet import render
from tests.support.fleet_results import results
from tests.support.plot_lines import labels, line, panel


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return summarise(open_fleet(results(tmp_path_factory.mktemp("fleet") / "r.parquet")))


def test_every_log_is_a_point_and_the_far_one_a_mark_at_the_edge(found):
    pads = found.looks[0]
    order = panel(sheet(found, pads), "order")
    low, high = window(pads)
    assert np.array_equal(order.lines[0].x, pads.rows + 1)
    assert np.array_equal(order.lines[0].y, np.clip(pads.values, low, high))
    x, y = line(order, "stands apart")
    assert 134 in x
    assert max(y) == high < 0.55
    assert ("car134", 134.0, high) in order.texts


def test_the_levels_of_a_change_are_drawn(found):
    pads = found.looks[0]
    drawn, quiet = (panel(sheet(found, look), "order") for look in (pads, found.looks[1]))
    assert line(drawn, "level")[1].tolist() == [pads.change.before] * 2
    assert "level" not in labels(quiet)


@pytest.mark.parametrize("n", [1, 3, 12])
def test_small_fleets_are_drawn(tmp_path, n):
    few = summarise(open_fleet(results(tmp_path / "r.parquet", n)))
    for look in few.looks:
        low, high = window(look)
        assert n >= 10 or (low <= look.values.min() and look.values.max() <= high)
        assert render(sheet(few, look).overview(), ".png").startswith(b"\x89PNG")


def test_a_name_with_dollars_and_slashes_is_drawn_as_it_is(tmp_path):
    import pyarrow as pa

    odd = {"a$b/c$": ([1.0, 2.0, 3.0], pa.float64(), "1")}
    few = summarise(open_fleet(results(tmp_path / "r.parquet", 3, extra=odd)))
    look = next(one for one in few.looks if one.metric.name == "a$b/c$")
    assert sheet(few, look).panels[0].title == "a$b/c$"

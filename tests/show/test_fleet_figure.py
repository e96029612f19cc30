import numpy as np
import pytest

from calib.line.fleet.results import open_fleet
from calib.line.fleet.summary import summarise
from calib.show.fleet_figure import distribution, in_order, picture_name, sheet, window
from calib.show.sheet import render
from tests.support.fleet_results import results
from tests.support.plot_lines import axes, labels, line


@pytest.fixture(scope="module")
def found(tmp_path_factory):
    return summarise(open_fleet(results(tmp_path_factory.mktemp("fleet") / "r.parquet")))


def test_every_log_is_a_point_and_the_far_one_a_mark_at_the_edge(found):
    pads, ax = found.looks[0], axes()
    in_order(ax, found, pads)
    low, high = window(pads)
    points = ax.get_lines()[0]
    assert np.array_equal(points.get_xdata(), pads.rows + 1)
    assert np.array_equal(points.get_ydata(), np.clip(pads.values, low, high))
    x, y = line(ax, "stands apart: 0.55")
    assert 134 in x
    assert max(y) == high < 0.55


def test_the_levels_of_a_change_are_drawn(found):
    pads, ax = found.looks[0], axes()
    in_order(ax, found, pads)
    assert "level" in labels(ax)
    assert line(ax, "level")[1].tolist() == [pads.change.before] * 2
    quiet = axes()
    in_order(quiet, found, found.looks[1])
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
    ax = axes()
    distribution(ax, look)
    assert ax.get_xlabel() == r"a\$b/c\$"
    assert picture_name(look.metric.name) == "a_b_c_.png"

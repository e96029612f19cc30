from dataclasses import replace

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


def test_every_panel_has_the_limits_beyond_which_a_log_is_named(found):
    for look in found.looks[:2]:
        alone, along = axes(), axes()
        distribution(alone, look)
        in_order(along, found, look)
        for ax in (alone, along):
            (told,) = (label for label in labels(ax) if label.startswith("named below "))
            assert [float(x) for x in told.removeprefix("named below ").split(" or above ")] == (
                pytest.approx(look.spread.edges, abs=0.001)
            )


def test_limits_that_are_far_away_are_told_and_not_drawn(found):
    pads = found.looks[0]
    far = replace(pads, spread=replace(pads.spread, edges=(-50.0, 50.0)))
    ax = axes()
    distribution(ax, far)
    assert "named below -50.0000 or above 50.0000 (not in view)" in labels(ax)
    assert max(ax.get_xlim()) < 1.0


def test_the_bars_hold_the_bulk(found):
    pads, ax = found.looks[0], axes()
    distribution(ax, pads)
    low, high = window(pads)
    counted = sum(bar.get_height() for bar in ax.patches if bar.get_y() == 0.0)
    inside = np.sum((pads.values >= low) & (pads.values <= high))
    assert counted >= inside
    assert "stands apart: 0.55" in labels(ax)
    near = replace(pads, outlying=pads.values == np.median(pads.values))
    ax = axes()
    distribution(ax, near)
    assert "stands apart" in labels(ax)
    assert not any(label.startswith("stands apart:") for label in labels(ax))


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

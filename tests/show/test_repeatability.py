import numpy as np
import pytest

from calib.line.gauge.study import study
from calib.show.repeatability import by_car, facts, sheet
from tests.line.gauge.test_study import readings
from tests.support.plot_lines import axes, drawn, labels


@pytest.fixture(scope="module")
def found():
    return study(readings(cars=4, stations=2, repeats=2))


def test_every_ramp_and_the_mean_of_every_car_is_drawn(found):
    ax = axes()
    by_car(ax, found, found.results[0])
    assert labels(ax) == ["line 0", "line 1"]
    values = found.results[0].values
    points = np.concatenate(
        [one.get_ydata() for one in ax.get_lines() if len(one.get_xdata()) == 8]
    )
    assert sorted(points) == sorted(values)
    mean = float(np.mean(values[:4]))
    assert drawn(ax, np.array([-0.35, 0.35]), np.array([mean, mean]))


def test_the_facts_have_a_row_for_every_metric_and_the_page_its_panels(found):
    told, page = facts(found), sheet(found)
    rows = told.tables[0].rows
    assert len(page.rows) == len(rows) == len(found.results) == 2
    assert rows[0][4] == f"{100.0 * found.results[0].gauge.grr:.1f}"
    assert set(rows[1][1:-1]) == {"-"}  # its repeats do not scatter
    assert told.verdict == "passed"

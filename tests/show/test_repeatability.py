import numpy as np
import pytest

from calib.line.gauge.study import study
from calib.show.repeatability import facts, sheet
from tests.line.gauge.test_study import readings
from tests.support.plot_lines import labels


@pytest.fixture(scope="module")
def found():
    return study(readings(cars=4, stations=2, repeats=2))


def test_every_ramp_and_the_mean_of_every_car_is_drawn(found):
    panel, values = sheet(found).panels[0], found.results[0].values
    points = [line.y for line in panel.lines if line.label]
    assert sorted(np.concatenate(points)) == sorted(values)
    assert labels(panel) == {"line 0", "line 1", ""}
    assert next(line.y[0] for line in panel.lines if not line.label) == np.mean(values[:4])


def test_the_facts_have_a_row_for_every_metric_and_the_page_its_panels(found):
    told, page = facts(found), sheet(found)
    rows = told.parts[0].tables[0].rows
    assert len(page.panels) == len(rows) == len(found.results) == 2
    assert rows[0][4] == f"{100.0 * found.results[0].gauge.grr.value:.1f}"
    assert set(rows[1][1:-1]) == {"-"}  # its repeats do not scatter
    assert told.verdict == "passed"

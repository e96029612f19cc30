from dataclasses import replace

import numpy as np
import pytest

from calib.line.gauge.study import study
from calib.show.repeatability import facts, sheet
from tests.line.gauge.test_study import readings
from tests.support.plot_lines import labels


@pytest.fixture(scope="module")
def found():
    return study(readings(cars=4, stations=2, repeats=2))


def test_every_ramp_and_the_mean_of_every_car_is_drawn_and_bad_metrics_too(found):
    (panel,), values = sheet(found).panels, found.results[0].values
    points = [line.y for line in panel.lines if line.label]
    assert sorted(np.concatenate(points)) == sorted(values)
    assert labels(panel) == {"line 0", "line 1", ""}
    assert next(line.y[0] for line in panel.lines if not line.label) == np.mean(values[:4])
    worse = study(readings(cars=4, stations=2, repeats=2, sd=(1.0, 0.9, 0.9)))
    named = tuple(replace(one, name=name) for one, name in zip(worse.results, "ab", strict=True))
    bad = replace(worse, results=named[::-1])
    assert [panel.name for panel in sheet(bad).panels] == ["b-values", "a-values"]


def test_the_facts_have_a_row_for_every_metric(found):
    told = facts(found)
    rows = told.parts[0].tables[0].rows
    assert len(rows) == len(found.results) == 2
    assert rows[0][4] == f"{100.0 * found.results[0].gauge.grr.value:.1f}"
    assert set(rows[1][1:-1]) == {"-"}  # its repeats do not scatter
    assert told.verdict == "passed"

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


def test_every_ramp_and_the_mean_of_every_car_is_drawn(found):
    panel, values = sheet(found).panels[1], found.results[0].values
    points = [line.y for line in panel.lines if line.label]
    assert sorted(np.concatenate(points)) == sorted(values)
    assert labels(panel) == {"line 0", "line 1", ""}
    assert next(line.y[0] for line in panel.lines if not line.label) == np.mean(values[:4])


def test_all_verdicts_are_in_one_panel_and_bad_metrics_have_their_own(found):
    whole, *strips = sheet(found).panels
    share = found.results[0].gauge.grr  # repeats of the other one do not scatter
    drawn = [(list(line.x), list(line.y)) for line in whole.lines]
    assert ([0], [100.0 * share.value]) in drawn
    assert ([0, 0], [100.0 * end for end in share.ci95]) in drawn
    assert ([-0.48, 0.48], [30.0, 30.0]) in drawn  # AIAG
    assert len(drawn) == 3
    assert [mark.look["color"] for mark in whole.marks] == ["#DDF1EA", "#FFFFFF"]
    assert [panel.name for panel in strips] == ["x-values"]
    worse = study(readings(cars=4, stations=2, repeats=2, sd=(1.0, 0.9, 0.9)))
    named = tuple(replace(one, name=name) for one, name in zip(worse.results, "ab", strict=True))
    bad = replace(worse, results=named[::-1])
    assert [panel.name for panel in sheet(bad).panels] == ["verdicts", "b-values", "a-values"]


def test_the_facts_have_a_row_for_every_metric(found):
    told = facts(found)
    rows = told.parts[0].tables[0].rows
    assert len(rows) == len(found.results) == 2
    assert rows[0][4] == f"{100.0 * found.results[0].gauge.grr.value:.1f}"
    assert set(rows[1][1:-1]) == {"-"}  # its repeats do not scatter
    assert told.verdict == "passed"

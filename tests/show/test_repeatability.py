from dataclasses import replace

import numpy as np
import pytest
from matplotlib.colors import to_hex

from calib.estimation.limits import Limit
from calib.line.gauge.study import GaugeVerdict, study
from calib.show.repeatability import HEAT, by_car, components, heat, sheet
from calib.show.sheet import render
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


def test_bars_are_shares_of_the_total_with_their_intervals(found):
    ax = axes()
    components(ax, found.results[0])
    parts = found.results[0].gauge.components
    names = [label.get_text() for label in ax.get_yticklabels()]
    assert names == ["repeatability", "station", "car by station", "gauge", "cars"]
    widths = [bar.get_width() for bar in ax.patches if bar.get_height() == pytest.approx(0.55)]
    assert widths[-1] == pytest.approx(100.0 * parts["car"].sd / parts["total"].sd)
    low, high = (100.0 * end / parts["total"].sd for end in parts["repeatability"].sd95)
    assert drawn(ax, np.array([low, high]), np.array([0, 0]))


def test_a_negative_variance_says_so():
    made = (study(readings(cars=4, stations=2, repeats=2, seed=s)) for s in range(20))
    found = next(f for f in made if f.results[0].gauge.negative)
    ax = axes()
    components(ax, found.results[0])
    assert "came out negative" in [text.get_text() for text in ax.texts]


def test_the_page_has_a_row_for_every_figure(found):
    page = sheet(found)
    assert len(page.rows) == len(found.results) + 1 == 3
    assert page.rows[0] == ("summary",) * 3
    assert render(page.overview(), ".png").startswith(b"\x89PNG")


def named(name, **how):
    """The study of one metric of this name."""
    made = readings(**how)
    return tuple(replace(r, metrics={name: r.metrics["x"]}) for r in made)


def cells(ax):
    return [
        (text.get_text(), to_hex(patch.get_facecolor()).upper())
        for text, patch in zip(ax.texts, ax.patches, strict=True)
    ]


def test_the_first_row_is_one_cell_a_metric():
    found = study(readings())
    ax = axes()
    heat(ax, found)
    good = found.results[0].gauge
    assert cells(ax) == [
        (f"{100.0 * good.grr:.0f} %\nndc {good.categories}", HEAT[GaugeVerdict.GOOD]),
        ("repeats do\nnot scatter", HEAT[GaugeVerdict.NOT_JUDGED]),
    ]
    assert [tick.get_text() for tick in ax.get_xticklabels()] == ["x\ngood", "same\nnot judged"]


def test_cars_that_do_not_differ_have_no_grr_but_one_of_the_tolerance():
    alike = named("pad_scale", sd=(0.0, 0.0, 0.5))
    ax = axes()
    heat(ax, study(alike))
    assert cells(ax) == [("the cars\ndo not differ", HEAT[GaugeVerdict.ALIKE])]
    ax = axes()
    known = study(alike, (Limit("pad_scale", -25.0, 25.0),))
    heat(ax, known)
    assert cells(ax)[0] == ("the cars\ndo not differ", HEAT[GaugeVerdict.ALIKE])
    text, colour = cells(ax)[1]
    assert colour == HEAT[GaugeVerdict.GOOD]
    assert float(text.rstrip(" %")) == pytest.approx(6.0, abs=1.5)  # 6 * 0.5 / 50
    assert sheet(known).result == "Passed"
    assert sheet(study(alike)).result == "Failed: pad level"

from dataclasses import replace

import pytest
from matplotlib.colors import to_hex

from calib.gauge.study import GaugeVerdict, study
from calib.plots.grr import HEAT, heat
from calib.plots.repeatability import sheet
from calib.validation.limits import Limit
from tests.gauge.test_study import readings
from tests.support.plot_lines import axes


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

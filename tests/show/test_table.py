from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import RegularGridInterpolator

from calib.show import table as figures
from calib.show.ramp import measure
from calib.table.curves import MEASURED
from tests.support.plot_lines import labels, line, panel
from tests.support.reference_car import IDEAL, one_axle
from tests.support.tables import made_table

TABLE = made_table()


def test_f1_and_f2_are_those_of_the_table_and_thin_where_no_ramp_measured_them():
    drawn = panel(figures.table_sheet(TABLE, "sedan@1"), "f1-f2")
    for label, y in (("f1, front", TABLE.paper.f1), ("f2, rear", TABLE.paper.f2)):
        thin, thick = next(pair for pair in pairwise(drawn.lines) if pair[1].label == label)
        assert np.array_equal(thin.y, y)
        measured = TABLE.paper.flag == MEASURED
        assert np.array_equal(thick.y, np.where(measured, y, np.nan), equal_nan=True)
        assert not measured.all()


def test_measured_points_of_a_ramp_are_drawn_over_the_curves(sedan, ramp):
    run = measure(sedan, ramp)
    sheet = figures.table_sheet(sedan, "sedan@1", (run,))
    # a ring is the mean of five blocks of 50 ms
    first = run.braked.nonzero()[0][:5]
    x, y = line(panel(sheet, "f1-f2"), "ramps, drag taken out")
    assert x[0] == pytest.approx(100.0 * (run.eta - 1.0)[first].mean())
    assert y[0] == pytest.approx(run.f1[first].mean())


def test_a_ramp_with_one_axle_is_not_drawn_over_the_curves_of_both(sedan, ramp):
    for run, there in ((one_axle(IDEAL, "r"), False), (ramp, True)):
        sheet = figures.table_sheet(sedan, "sedan@1", (measure(sedan, run),))
        assert ("ramps, drag taken out" in labels(panel(sheet, "f1-f2"))) == there


def test_the_usable_range_is_marked():
    # z = 60 (eta - 1), known up to 0.475 % and 0.285 g
    percent, end = 100.0 * (TABLE.paper.eta[-2] - 1.0), TABLE.paper.z[-2]
    assert (percent, end) == pytest.approx((0.475, 0.285))
    drawn = panel(figures.table_sheet(TABLE, "sedan@1"), "f1-f2")
    upright, grey = drawn.marks
    assert (upright.start, upright.end, grey.start) == pytest.approx((0.475,) * 3)
    assert grey.end == drawn.xlim[1]


def test_the_drawn_map_has_the_pad_ratios_of_the_table(sedan):
    drawn = panel(figures.table_sheet(sedan, "sedan@1"), "map")
    read = RegularGridInterpolator((*sedan.map.axes.values(),), sedan.map.grid("change"))
    values = drawn.field.values
    eta_less_1, z = (np.linspace(*ends, values.shape[0]) for ends in (drawn.xlim, drawn.ylim))
    places = [(i, j) for i, j in np.argwhere(np.isfinite(values)) if z[i] >= sedan.map.z[0]]
    assert len(places) > 0.5 * values.size
    expected = read([(z[i], 0.01 * eta_less_1[j] / z[i], 0.0) for i, j in places])
    assert [values[place] for place in places] == pytest.approx(np.exp(expected))

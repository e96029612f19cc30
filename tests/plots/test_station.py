"""What the report draws are the numbers of the estimate."""

import numpy as np
import pytest

from calib.plots.station import sheet
from tests.support.station_run import failed_car


@pytest.fixture(scope="module")
def found():
    return failed_car()


def axes_of(sheet, name):
    return sheet.figure(name).axes[0]


def test_the_points_are_the_pads_of_the_stops(found):
    ax = axes_of(sheet(found.table, found.results), "pads")
    points = {c.get_label(): c[0].get_xydata()[:, 1] for c in ax.containers}
    assert np.allclose(points["front, stop"], [r.figures["pad_friction_f"] for r in found.results])
    assert np.allclose(points["rear, stop"], [r.figures["pad_friction_r"] for r in found.results])


def test_a_name_with_a_dollar_is_drawn_as_text(found):
    ax = axes_of(sheet(found.table, found.results), "stop-1")
    assert ax.get_title(loc="left").count(r"\$") == 1


def test_a_line_ends_where_the_estimate_is_not_valid(found):
    drawn = sheet(found.table, found.results)
    line = axes_of(drawn, "stop-2").get_lines()[0].get_ydata()
    valid = found.results[1].estimate.valid[::5]
    assert np.array_equal(np.isfinite(line), valid)


def test_no_band_is_drawn_where_the_estimate_is_not_valid(found):
    ax = axes_of(sheet(found.table, found.results), "stop-2")
    result = found.results[1].estimate
    first = result.time[np.argmax(result.valid)]
    bands = [one for one in ax.collections if one.get_facecolor()[0][3] < 1.0]
    assert len(bands) == 2
    for band in bands:
        assert band.get_paths()[0].vertices[:, 0].min() >= first

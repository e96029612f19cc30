import matplotlib as mpl
import numpy as np

from calib.show.style import envelope, smooth, styled

TIME = np.arange(0.0, 2.0, 0.005)


def test_settings_of_the_user_are_neither_used_nor_lost():
    with mpl.rc_context({"font.size": 31.0, "lines.linewidth": 9.0, "axes.facecolor": "black"}):
        with styled():
            assert mpl.rcParams["font.size"] < 10.0
            assert mpl.rcParams["axes.facecolor"] == "white"
        assert mpl.rcParams["font.size"] == 31.0
        assert mpl.rcParams["axes.facecolor"] == "black"


def test_unknown_values_stay_unknown_and_change_no_other_mean():
    values = np.full(TIME.size, 2.0)
    values[100:150] = np.nan
    means = smooth(TIME, values)
    assert np.array_equal(np.isnan(means), np.isnan(values))
    assert np.nanmax(np.abs(means - 2.0)) < 1e-12


def test_no_peak_of_a_long_line_is_lost():
    values = np.zeros(100_000)
    values[43_210], values[70_000:80_000] = 7.0, np.nan
    indices = envelope(values, 2000)
    assert indices.size == 4000
    assert np.all(np.diff(indices) >= 0)
    assert 43_210 in indices
    assert np.isnan(values[indices]).sum() == 400
    assert np.array_equal(envelope(values[:8000], 2000), np.arange(8000))

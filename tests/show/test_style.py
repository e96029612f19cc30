import matplotlib as mpl
import numpy as np
import pytest

from calib.show.style import envelope, reach, smooth, styled

TIME = np.arange(0.0, 2.0, 0.005)


def test_settings_of_the_user_are_neither_used_nor_lost():
    with mpl.rc_context({"font.size": 31.0, "lines.linewidth": 9.0, "axes.facecolor": "black"}):
        with styled():
            assert mpl.rcParams["font.size"] < 10.0
            assert mpl.rcParams["axes.facecolor"] == "white"
        assert mpl.rcParams["font.size"] == 31.0
        assert mpl.rcParams["axes.facecolor"] == "black"


def test_the_mean_keeps_a_line_and_takes_noise():
    straight = 3.0 * TIME - 1.0
    inside = slice(20, -20)
    assert smooth(TIME, straight)[inside] == pytest.approx(straight[inside])
    noise = np.random.default_rng(0).normal(size=TIME.size)
    # 21 samples: the standard deviation falls by sqrt(21)
    assert np.std(smooth(TIME, noise)) == pytest.approx(np.std(noise) / np.sqrt(21), rel=0.3)


def test_what_is_unknown_stays_unknown_and_spreads_not():
    values = np.full(TIME.size, 2.0)
    values[100:150] = np.nan
    found = smooth(TIME, values)
    assert np.array_equal(np.isnan(found), np.isnan(values))
    assert np.nanmax(np.abs(found - 2.0)) < 1e-12


@pytest.mark.parametrize("zero", [False, True])
def test_an_axis_holds_the_values_and_only_them(zero):
    low, high = reach(np.array([2.0, np.nan, 3.0]), zero=zero)
    assert low <= (0.0 if zero else 2.0)
    assert 3.0 < high < 4.0
    assert reach(np.array([np.nan])) is None


def test_no_peak_of_a_long_line_is_lost():
    values = np.zeros(100_000)
    values[43_210], values[70_000:80_000] = 7.0, np.nan
    at = envelope(values, 2000)
    assert at.size == 4000
    assert np.all(np.diff(at) >= 0)
    assert 43_210 in at
    assert np.isnan(values[at]).sum() == 400
    assert np.array_equal(envelope(values[:8000], 2000), np.arange(8000))

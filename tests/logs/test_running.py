"""Clocks that wrap, jump and go back."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.errors import LogError
from calib.logs.clock import PERIODS, running


@given(
    st.sampled_from(sorted(PERIODS.values())),
    st.floats(0.1, 0.9),
    st.lists(st.floats(0.0, 0.5), min_size=20, max_size=60),
)
def test_a_counter_that_wraps_is_followed(period, start, steps):
    true = start * period + np.cumsum(steps)
    wraps = np.flatnonzero(np.diff(np.floor(true / period)) > 0)
    time, notes = running(np.mod(true, period), "run")
    np.testing.assert_allclose(np.diff(time), np.diff(true), atol=1e-6 + 1e-12 * period)
    assert len(notes) == wraps.size


def test_it_wraps_more_than_once():
    true = np.arange(0.0, 200.0, 0.01)
    time, notes = running(np.mod(true, 65.536), "run")
    np.testing.assert_allclose(time, true, atol=1e-9)
    assert len(notes) == 3
    assert "16 bits of milliseconds" in notes[0]


def test_an_offset_is_kept():
    time = 1.7e9 + np.arange(100) * 0.01
    assert running(time, "run")[0] is not time
    np.testing.assert_array_equal(running(time, "run")[0], time)


def test_frames_out_of_order_stay_as_they_are():
    time = np.asarray([0.0, 0.010, 0.009, 0.02, 0.03, 0.04, 0.05, 0.06])
    found, notes = running(time, "run")
    np.testing.assert_array_equal(found, time)
    assert notes == ()


@pytest.mark.parametrize(
    ("time", "words"),
    [
        (np.append(np.arange(500.0), np.arange(500.0)), "goes back by 499 s, from 499 s"),
        (np.tile([0.01, 0.002], 50), "50 of 100 timestamps"),
        (np.asarray([0.0, np.nan, 1.0]), "not a number"),
    ],
)
def test_what_is_no_clock(time, words):
    with pytest.raises(LogError, match=words):
        running(time, "run")

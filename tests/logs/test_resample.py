"""Several rasters onto one clock: exact on straight lines, nothing beyond the samples."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.errors import LogError
from calib.logs.resample import Wanted, on_one_clock
from calib.logs.source import ChannelTrace


def wanted(name, time, values=None, hold=False, clock=None):
    time = np.asarray(time, float)
    values = 3.0 * time + 1.0 if values is None else np.asarray(values, float)
    return Wanted(name, ChannelTrace(clock or name, time, values), hold)


@given(
    st.lists(st.floats(0.001, 0.02), min_size=60, max_size=80),
    st.lists(st.floats(0.002, 0.05), min_size=40, max_size=60),
    st.floats(-0.2, 0.2),
)
def test_a_straight_line_stays_one_on_any_rasters(steps, others, late):
    """Linear interpolation is exact there, whatever the jitter; nothing lies outside."""
    fast, slow = np.cumsum(steps), np.cumsum(others) + late
    if min(fast[-1], slow[-1]) <= max(fast[0], slow[0]):
        return
    found = on_one_clock([wanted("omega_fl", fast), wanted("p_mc", slow)], "run")
    for values in found.values:
        there = ~np.isnan(values)
        np.testing.assert_allclose(values[there], 3.0 * found.time[there] + 1.0, atol=1e-9)
    if found.time.size:
        assert found.time[0] >= max(fast[0], slow[0])
        assert found.time[-1] <= min(fast[-1], slow[-1])


def test_the_fastest_raster_is_the_clock_and_keeps_its_samples():
    fast, slow = np.arange(0, 1, 0.005), np.arange(0, 1, 0.01)
    noise = np.random.default_rng(1).normal(size=fast.size)
    found = on_one_clock([wanted("p_mc", slow), wanted("omega_fl", fast, noise)], "run")
    kept = (fast >= slow[0]) & (fast <= slow[-1])
    np.testing.assert_array_equal(found.time, fast[kept])
    np.testing.assert_array_equal(found.values[1], noise[kept])
    assert "omega_fl (omega_fl, 200 Hz) is the clock" in found.notes
    assert "p_mc (p_mc, 100 Hz) interpolated linearly" in found.notes


def test_of_rasters_as_fast_the_one_with_the_wheels_is_taken():
    wheels, other = np.arange(0, 1, 0.01), 0.004 + np.arange(0, 1, 0.0099)
    traces = [wanted("p_mc", other), wanted("omega_fl", wheels), wanted("a_x", other)]
    assert np.isin(on_one_clock(traces, "run").time, wheels).all()


def test_a_raster_beyond_one_kilohertz_is_no_clock():
    traces = [wanted("p_mc", np.arange(0, 1, 1e-4)), wanted("omega_fl", np.arange(0, 1, 0.005))]
    assert on_one_clock(traces, "run").time.size == 200


def test_the_pages_of_a_multiplexed_message_are_no_clock():
    """Two pages, 1 ms and 9 ms apart, have 200 samples a second as the wheels have."""
    wheels, pages = np.arange(0, 1, 0.005), np.arange(0, 1, 0.01)
    both = np.sort([*pages, *(pages + 0.001)])
    traces = [wanted("Page", both), wanted("other", both, clock="Page"), wanted("WhlFL", wheels)]
    assert np.isin(on_one_clock(traces, "run").time, wheels).all()


def test_a_state_holds_its_last_value():
    time = np.arange(0, 1, 0.01)
    gear = wanted("steering", [0.0, 0.305, 0.99], [1.0, 2.0, 3.0], hold=True)
    _, values = on_one_clock([wanted("omega_fl", time), gear], "run").values
    np.testing.assert_array_equal(values, np.where(time < 0.305, 1.0, np.where(time < 0.99, 2, 3)))


def test_an_optional_channel_shortens_the_log_a_little_at_most():
    time = np.arange(0, 5, 0.01)
    late, later = wanted("v", time[time > 0.3]), wanted("T_disc_f", time[time > 2])
    found = on_one_clock([wanted("omega_fl", time), late, later], "run")
    assert found.time[0] == pytest.approx(0.31)
    assert np.isnan(found.values[2][:10]).all()
    assert not np.isnan(found.values[1]).any()
    assert "0.310 s at the start and 0.000 s at the end were cut off" in found.notes[-1]


def test_samples_out_of_order_twice_and_invalid():
    p = wanted("p_mc", [0.0, 0.2, 0.1, 0.3, 0.3, 0.4], [0, 2, 1, 99, 3, np.nan])
    clock = wanted("omega_fl", np.arange(0, 0.31, 0.05))
    found = on_one_clock([clock, p], "run")
    np.testing.assert_allclose(found.values[1], found.time * 10)
    assert "p_mc: 1 samples are marked invalid and were left out" in found.notes
    assert any("1 samples repeat a time" in note for note in found.notes)


def test_no_time_in_common():
    traces = [wanted("omega_fl", np.arange(0, 1, 0.01)), wanted("p_mc", np.arange(2, 3, 0.01))]
    with pytest.raises(LogError, match=r"p_mc 2\.000 to 2\.990 s"):
        on_one_clock(traces, "run")


def test_an_empty_channel_has_no_values():
    traces = [wanted("omega_fl", np.arange(0, 1, 0.01)), wanted("v", [])]
    assert np.isnan(on_one_clock(traces, "run").values[1]).all()
    with pytest.raises(LogError, match="every channel is empty"):
        on_one_clock(traces[1:], "run")

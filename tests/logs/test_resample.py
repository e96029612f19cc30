"""Several rasters onto one clock: exact on straight lines, nothing beyond the samples."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from calib.base.errors import LogError
from calib.logs.clock import on_line
from calib.logs.resample import on_one_clock
from calib.logs.source import ChannelTrace


def trace(name, time, values=None, state=False, clock=None):
    time = np.asarray(time, float)
    values = 3.0 * time + 1.0 if values is None else np.asarray(values, float)
    return ChannelTrace(clock or name, time, values, state, name)


@given(
    st.lists(st.floats(0.001, 0.02), min_size=60, max_size=80),
    st.lists(st.floats(0.002, 0.05), min_size=40, max_size=60),
    st.floats(-0.2, 0.2),
)
def test_a_straight_line_stays_one_on_any_rasters(steps, others, late):
    """Linear interpolation is exact there, whatever the jitter; nothing lies outside."""
    fast, slow = np.cumsum(steps), np.cumsum(others) + late
    assume(min(fast[-1], slow[-1]) > max(fast[0], slow[0]))
    assume(not on_line(fast)[1] and not on_line(slow)[1])  # rounded times would be moved
    resampled = on_one_clock([trace("omega_fl", fast), trace("p_mc", slow)], "run")
    for values in resampled.values:
        valid = ~np.isnan(values)
        np.testing.assert_allclose(values[valid], 3.0 * resampled.time[valid] + 1.0, atol=1e-9)
    if resampled.time.size:
        assert resampled.time[0] >= max(fast[0], slow[0])
        assert resampled.time[-1] <= min(fast[-1], slow[-1])


def test_the_fastest_raster_is_the_clock_and_keeps_its_samples():
    fast, slow = np.arange(0, 1, 0.005), np.arange(0, 1, 0.01)
    noise = np.random.default_rng(1).normal(size=fast.size)
    resampled = on_one_clock([trace("p_mc", slow), trace("omega_fl", fast, noise)], "run")
    is_common = (fast >= slow[0]) & (fast <= slow[-1])
    np.testing.assert_array_equal(resampled.time, fast[is_common])
    np.testing.assert_array_equal(resampled.values[1], noise[is_common])
    assert "omega_fl (omega_fl, 200 Hz) is the clock" in resampled.notes
    assert "p_mc (p_mc, 100 Hz) interpolated linearly" in resampled.notes


WHEELS = np.arange(0, 1, 0.005)
PAGES = np.sort([*np.arange(0, 1, 0.01), *(np.arange(0, 1, 0.01) + 0.001)])


@pytest.mark.parametrize(
    ("clock", "others"),
    [
        ("", {"p_mc": 0.004 + np.arange(0, 1, 0.00495)}),  # as fast
        ("", {"p_mc": np.arange(0, 1, 1e-4)}),  # beyond one kilohertz
        ("Page", {"Page": PAGES, "other": PAGES}),  # two pages of a multiplexed message
    ],
)
def test_the_wheels_are_the_clock(clock, others):
    traces = [trace(name, time, clock=clock) for name, time in others.items()]
    resampled = on_one_clock([*traces, trace("omega_fl", WHEELS)], "run").time
    assert np.isin(resampled, WHEELS).all()
    assert resampled.size > 190


def test_a_state_holds_its_last_value():
    time = np.arange(0, 1, 0.01)
    gear = trace("steering", [0.0, 0.305, 0.99], [1.0, 2.0, 3.0], state=True)
    _, values = on_one_clock([trace("omega_fl", time), gear], "run").values
    np.testing.assert_array_equal(values, np.where(time < 0.305, 1.0, np.where(time < 0.99, 2, 3)))


def test_an_optional_channel_shortens_the_log_a_little_at_most():
    time = np.arange(0, 5, 0.01)
    late, later = trace("v", time[time > 0.3]), trace("T_disc_f", time[time > 2])
    resampled = on_one_clock([trace("omega_fl", time), late, later], "run")
    assert resampled.time[0] == pytest.approx(0.31)
    assert np.isnan(resampled.values[2][:10]).all()
    assert not np.isnan(resampled.values[1]).any()
    assert "0.310 s at the start and 0.000 s at the end were cut off" in resampled.notes[-1]


def test_samples_out_of_order_twice_and_invalid():
    p = trace("p_mc", [0.0, 0.2, 0.1, 0.3, 0.3, 0.4], [0, 2, 1, 99, 3, np.nan])
    clock = trace("omega_fl", np.arange(0, 0.31, 0.05))
    resampled = on_one_clock([clock, p], "run")
    np.testing.assert_allclose(resampled.values[1], resampled.time * 10)
    assert "p_mc: 1 samples are marked invalid and were left out" in resampled.notes
    assert any("1 samples repeat a time" in note for note in resampled.notes)


def test_no_time_in_common_and_no_samples():
    wheels, empty = trace("omega_fl", np.arange(0, 1, 0.01)), trace("v", [])
    late = trace("p_mc", np.arange(2, 3, 0.01))
    assert np.isnan(on_one_clock([wheels, empty], "run").values[1]).all()
    for traces in ([wheels, late], [empty]):
        with pytest.raises(LogError):
            on_one_clock(traces, "run")

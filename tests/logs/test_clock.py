"""Even clocks of few digits, and times out of order."""

import numpy as np
import pytest

from calib.base.errors import LogError
from calib.logs.clock import check_running, evened, on_line, step_of


def kept(size, lost=()):
    """Numbers of the rows that were not lost."""
    return np.delete(np.arange(size), lost)


@pytest.mark.parametrize("rate", [95.0, 150.0, 256.0, 300.0, 700.0])
@pytest.mark.parametrize("lost", [(), (300,), range(600, 1000)])
@pytest.mark.parametrize("written", [np.round, np.floor], ids=["rounded", "cut"])
def test_whole_milliseconds_are_put_on_their_line(rate, lost, written):
    true = 3.0 + kept(2000, lost) / rate
    line, rounding = evened(written(1e3 * true) / 1e3)
    assert rounding == pytest.approx(1e-3, rel=1e-3)
    assert np.median(np.diff(line)) == pytest.approx(1.0 / rate, rel=2e-5)
    shift = line - true
    assert np.ptp(shift) < 2e-4  # how late the clock is as a whole moves nothing


@pytest.mark.parametrize("start", [3600.0, 30000.0, 32760.0])  # the last one: the spacing doubles
@pytest.mark.parametrize("rate", [50.0, 100.0, 120.0])
def test_float32_seconds_of_the_day(start, rate):
    true = start + np.arange(2000) / rate
    line, _ = on_line(true.astype(np.float32).astype(np.float64))
    assert step_of(line) == pytest.approx(1.0 / rate, rel=2e-4)
    assert np.ptp(line - true) < 1e-3


@pytest.mark.parametrize("jitter", [0.5e-3, 2e-3])
def test_a_clock_that_jitters_stays_as_it_is(jitter):
    rng = np.random.default_rng(3)
    time = np.arange(2000) / 100 + rng.uniform(-jitter, jitter, 2000)
    assert evened(time) is None
    assert step_of(time) == pytest.approx(0.01, rel=3e-4)


def test_a_clock_that_changes_its_rate_stays_as_it_is():
    true = np.cumsum(np.where(np.arange(2000) < 1000, 1 / 150, 1 / 155))
    assert evened(np.round(true, 3)) is None


def test_a_gap_is_no_part_of_the_step():
    time = np.arange(500) / 200
    time[300:] += 2.0
    assert step_of(time) == pytest.approx(0.005)


def test_frames_out_of_order_stay_as_they_are():
    time = np.asarray([0.0, 0.010, 0.009, 0.02, 0.03, 0.04, 0.05, 0.06])
    check_running(time, "run")


@pytest.mark.parametrize(
    "time",
    [np.tile(np.arange(500.0), 2), np.tile([0.01, 0.002], 50), np.asarray([0.0, np.nan, 1.0])],
    ids=["two runs", "to and fro", "no number"],
)
def test_what_is_no_clock(time):
    with pytest.raises(LogError):
        check_running(time, "run")

"""Rate, jitter and gaps of clocks that are known."""

import numpy as np
import pytest

from calib.run.observation import clock_of


@pytest.mark.parametrize("rate", [40.0, 100.0, 200.0, 1000.0])
def test_even_clock(rate):
    clock = clock_of(np.arange(500) / rate)
    assert clock.rate == pytest.approx(rate)
    assert clock.duration == pytest.approx(499 / rate)
    assert clock.jitter == pytest.approx(0.0, abs=1e-12)
    assert clock.gaps == ()


def test_jitter_is_the_spread_of_the_steps():
    steps = np.tile([0.004, 0.005, 0.006], 200)
    clock = clock_of(np.concatenate([[0.0], np.cumsum(steps)]))
    assert clock.jitter == pytest.approx(0.001 * np.sqrt(2 / 3))


def test_gap_does_not_count_as_jitter():
    time = np.arange(500) / 200
    time[300:] += 0.5
    clock = clock_of(time)
    assert clock.jitter == pytest.approx(0.0, abs=1e-12)
    ((when, length),) = clock.gaps
    assert when == pytest.approx(299 / 200)
    assert length == pytest.approx(0.505)


def test_one_lost_sample_is_no_gap():
    time = np.delete(np.arange(500) / 200, 300)
    assert clock_of(time).gaps == ()

"""A pressure as the foot gave it."""

import numpy as np
import pytest

from calib.run.pedal import RELEASED, as_pressed


def test_without_noise_nothing_changes():
    t = np.arange(0.0, 5.0, 0.005)
    p = 20e5 * np.clip((t - 1.0) / 0.2, 0.0, 1.0)
    assert np.array_equal(as_pressed(p, 0.005), p)


def test_a_held_pressure_loses_its_noise_and_a_rise_stays():
    rng = np.random.default_rng(1)
    t = np.arange(0.0, 5.0, 0.005)
    clean = 20e5 * np.clip((t - 1.0) / 0.2, 0.0, 1.0)
    smooth = as_pressed(clean + rng.normal(0.0, 1e4, t.size), 0.005)
    constant = t > 1.6
    assert np.std((smooth - clean)[constant]) < 0.4e4
    rising = (t > 1.02) & (t < 1.18)
    assert smooth[rising] == pytest.approx(clean[rising], abs=5e4)


def test_noise_that_is_cut_at_zero_is_no_brake():
    rng = np.random.default_rng(2)
    p = np.maximum(rng.normal(0.0, 1e4, 1000), 0.0)
    assert np.mean(p) > 0.3e4
    assert np.mean(p) < RELEASED
    assert np.max(as_pressed(p, 0.005)) == 0.0


def test_a_noise_that_seldom_reaches_the_next_step_is_no_brake():
    """Gauss: 9 % of the readings exceed half a step of 0.1 bar at a noise of 0.0375 bar."""
    rng = np.random.default_rng(3)
    p = np.maximum(np.round(rng.normal(0.0, 0.0375, 400) / 0.1) * 1e4, 0.0)
    assert 0.05 < np.mean(p > 0.0) < 0.15
    assert np.max(as_pressed(p, 0.02)) == 0.0


T = np.arange(0.0, 5.0, 0.01)


def stop(rise):
    """Return a pressure [Pa] that rises to 20 bar within ``rise`` [s] and stays."""
    return 20e5 * np.clip((T - 1.0) / rise, 0.0, 1.0)


@pytest.mark.parametrize("rise", [0.1, 0.15, 0.4])
@pytest.mark.parametrize("seed", range(2))
def test_a_corner_leaves_no_peak_that_a_caliper_would_hold(rise, seed):
    """A play keeps the highest pressure. Of noise of 0.1 bar 4 sigma of a mean of ten are left."""
    p = stop(rise)
    noisy = p + np.random.default_rng(seed).normal(0.0, 1e4, p.size)
    assert np.max(as_pressed(noisy, 0.01)) < p[-1] + 4.0 * 1e4 / np.sqrt(10.0)


def test_a_foot_that_presses_too_far_stays():
    p = stop(0.2)
    over = np.where((T > 1.2) & (T < 1.5), 1e5 * np.sin(np.pi * (T - 1.2) / 0.3), 0.0)
    smooth = as_pressed(p + over + np.random.default_rng(7).normal(0.0, 0.5e4, T.size), 0.01)
    assert np.max(smooth) > p[-1] + 0.7e5

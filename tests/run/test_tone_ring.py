"""Errors that turn with a wheel are taken out of its speed, and nothing else is."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.run.axle_signals import signals, without_runout
from tests.support.reference_car import CAR, REAL, noisy, ramp, stop

STEP = 0.005
TIME = np.arange(0.0, 10.0, STEP)


def slowing(bite=0.0):
    """A wheel that rolls for 3 s at 90 rad/s and is then braked, with a slip of ``bite`` [1]."""
    slip = bite * np.clip((TIME - 3.0) / 0.3, 0.0, 1.0)
    return (90.0 - 8.0 * np.maximum(TIME - 3.0, 0.0)) * (1.0 - slip)


def angle(omega):
    return np.concatenate([[0.0], np.cumsum(0.5 * (omega[1:] + omega[:-1]) * STEP)])


@given(
    st.floats(5e-4, 4e-3),
    st.floats(0.0, 2.0 * np.pi),
    st.sampled_from([1, 2]),
    st.integers(0, 2**31),
)
def test_a_ring_is_told_by_the_angle_of_its_wheel(size, phase, order, seed):
    omega = slowing(bite=0.02)
    noise = 0.02 * np.random.default_rng(seed).standard_normal(TIME.size)
    read = omega * (1.0 + size * np.cos(order * angle(omega) + phase)) + noise
    left = (without_runout(read, STEP) - noise) / omega - 1.0
    assert np.sqrt(np.mean(left[TIME < 8.0] ** 2)) < 0.15 * size


@given(st.integers(0, 2**31), st.floats(0.0, 0.03))
def test_a_good_ring_is_left_alone(seed, bite):
    read = slowing(bite) + 0.02 * np.random.default_rng(seed).standard_normal(TIME.size)
    np.testing.assert_array_equal(without_runout(read, STEP), read)


@pytest.mark.parametrize("made", [ramp, stop])
def test_wheels_of_the_plant_are_left_alone(made):
    log = noisy(made(REAL), 3)
    expected = 0.5 * (log["omega_fl"] + log["omega_fr"])
    np.testing.assert_array_equal(signals(log, CAR).omega_f, expected)


@pytest.mark.parametrize("seconds", [0.05, 1.0])
def test_a_few_turns_tell_nothing(seconds):
    omega = np.full(round(seconds / STEP), 60.0)
    read = omega * (1.0 + 2e-3 * np.cos(angle(omega)))
    np.testing.assert_array_equal(without_runout(read, STEP), read)

"""Channels that are sent seldom, as straight lines between their values."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.run.copies import came_at, period_of, without_holds
from tests.support.measuring_chain import Message, chained
from tests.support.plant import as_log, drive
from tests.support.reference_car import IDEAL

LONGEST = 50.0


def straight(x, longest=LONGEST):
    came = came_at(x, longest)
    return x if came is None else np.interp(np.arange(x.size), came, x[came])


def held(x, period):
    return np.repeat(x[::period], period)[: x.size]


@given(st.integers(2, 20), st.integers(0, 19), st.integers(0, 2**32 - 1))
def test_noise_that_is_held_keeps_its_values_where_they_came(period, phase, seed):
    noise = np.random.default_rng(seed).normal(size=2000)
    x = held(noise, period)[phase:]
    found = straight(x)
    came = np.concatenate([[0], np.flatnonzero(np.diff(x)) + 1])
    assert period_of(x) == period
    np.testing.assert_allclose(found[came], x[came])
    middle = (came[1:-1] + came[2:]) / 2.0
    np.testing.assert_allclose(
        np.interp(middle, np.arange(x.size), found), (x[came[1:-1]] + x[came[2:]]) / 2.0
    )


@pytest.mark.parametrize("period", [2, 5, 10, 33])
def test_a_parabola_that_is_held_is_wrong_by_its_bend_alone(period):
    t = np.arange(1000.0)
    true = 30.0 - 1e-2 * t - 5e-6 * t**2
    x = held(true, period)
    last = 1000 - period - 1000 % period
    assert np.max(np.abs(straight(x) - true)[:last]) <= 5e-6 * period**2 / 4 + 1e-12
    assert np.max(np.abs(x - true)) > 1e-2 * (period - 1)


def test_a_value_that_stays_for_long_came_again_with_each_period():
    x = held(np.concatenate([np.arange(300.0), np.full(200, 300.0), np.arange(300.0, 0.0, -1)]), 10)
    found = straight(x)
    assert np.all(found[310:480] == 300.0)


def test_a_channel_that_changes_with_its_clock_is_not_changed():
    x = np.random.default_rng(1).normal(size=500)
    assert straight(x) is x
    rest = np.zeros(500)
    assert straight(rest) is rest


def test_what_is_kept_for_too_long_is_not_changed():
    x = held(np.random.default_rng(1).normal(size=5000), 60)
    assert straight(x) is x


def test_messages_that_do_not_fall_on_the_samples_are_told():
    log = as_log(drive(IDEAL, lambda t: 30e5 * min(max(t - 1, 0), 1), 30.0, rate=200.0), "stop")
    sent = chained(log, {"v": Message(30.0)}, np.random.default_rng(3))
    assert period_of(sent["v"]) == pytest.approx(200.0 / 30.0, rel=0.02)
    found = without_holds(sent)
    n = found.time.size
    assert log.time.size - n < 200.0 / 30.0 + 1.0  # nothing is known after the last value
    assert found.interpolated == ("v",)
    moving = log["v"][:n] > 3.0
    error, held_error = found["v"] - log["v"][:n], sent["v"][:n] - log["v"][:n]
    assert np.std(error[moving]) < 0.2 * np.std(held_error[moving])

"""Channels that are sent seldom, are copies, or derivatives."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.run.copies import _arrivals, _mean_period, copied_pairs, shares_of_speed, without_holds
from tests.support.made_runs import changed, made_run, stop
from tests.support.measuring_chain import Message, chained
from tests.support.plant import as_log, drive
from tests.support.reference_car import IDEAL, REAL, noisy, ramp

RUN = made_run(stop())


def interpolated(x, longest=50.0):
    arrivals = _arrivals(x, longest)
    return x if arrivals is None else np.interp(np.arange(x.size), arrivals, x[arrivals])


def held_for(period, x):
    return np.repeat(x[::period], period)[: x.size]


@given(st.integers(2, 20), st.integers(0, 19), st.integers(0, 2**32 - 1))
def test_held_noise_keeps_its_values_where_they_arrived(period, phase, seed):
    noise = np.random.default_rng(seed).normal(size=2000)
    x = held_for(period, noise)[phase:]
    straightened = interpolated(x)
    changes = np.concatenate([[0], np.flatnonzero(np.diff(x)) + 1])
    assert _mean_period(x) == period
    np.testing.assert_allclose(straightened[changes], x[changes])
    middle = (changes[1:-1] + changes[2:]) / 2.0
    between = np.interp(middle, np.arange(x.size), straightened)
    np.testing.assert_allclose(between, (x[changes[1:-1]] + x[changes[2:]]) / 2.0)


def test_a_value_that_stays_for_long_came_again_with_each_period():
    values = np.concatenate([np.arange(300.0), np.full(200, 300.0), np.arange(300.0, 0.0, -1)])
    x = held_for(10, values)
    assert np.all(interpolated(x)[310:480] == 300.0)


@pytest.mark.parametrize("period", [1, 60, 500])
def test_a_channel_that_is_not_held_or_held_too_long_is_not_changed(period):
    x = held_for(period, np.random.default_rng(1).normal(size=5000))
    assert interpolated(x) is x


def test_messages_between_the_samples_are_interpolated():
    log = as_log(drive(IDEAL, lambda t: 30e5 * min(max(t - 1, 0), 1), 30.0, rate=200.0), "stop")
    sent = chained(log, {"v": Message(30.0)}, np.random.default_rng(3))
    assert _mean_period(sent["v"]) == pytest.approx(200.0 / 30.0, rel=0.02)
    straightened = without_holds(sent)
    n = straightened.time.size
    assert log.time.size - n < 200.0 / 30.0 + 1.0  # nothing is known after the last value
    assert straightened.interpolated == ("v",)
    moving = log["v"][:n] > 3.0
    error, held_error = straightened["v"] - log["v"][:n], sent["v"][:n] - log["v"][:n]
    assert np.std(error[moving]) < 0.2 * np.std(held_error[moving])


def test_one_signal_under_two_names_is_found_also_where_both_are_held():
    names = ["omega_fl", "omega_fr", "v"]
    assert list(copied_pairs(RUN, names)) == []
    same = changed(RUN, omega_fr=1.001 * RUN["omega_fl"])
    assert [pair for *pair, _ in copied_pairs(same, names)] == [["omega_fl", "omega_fr"]]
    seldom = changed(same, **{name: held_for(5, same[name]) for name in names})
    assert [pair for *pair, _ in copied_pairs(seldom, names)] == [["omega_fl", "omega_fr"]]


@pytest.mark.parametrize("width", [2, 16])
def test_a_derivative_of_v_has_the_noise_of_v_and_no_other(width):
    log = noisy(ramp(REAL), 9)
    shift = width // 2
    derived = (np.roll(log["v"], -shift) - np.roll(log["v"], shift)) / (width * log.sample_time)
    derived[:shift], derived[-shift:] = derived[shift], derived[-shift - 1]
    with_derivative = replace(log, channels={**log.channels, "a_x": derived})
    assert dict(shares_of_speed(with_derivative))["v"] > 0.95
    assert max(share for _, share in shares_of_speed(log)) < 0.1

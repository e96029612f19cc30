"""Axle signals of made runs, and errors that turn with a wheel."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from calib.base.errors import LogError
from calib.run.axle_signals import signals
from calib.run.runout import without_runout
from tests.support.made_runs import changed, made_run, stop
from tests.support.reference_car import CAR, REAL, noisy
from tests.support.reference_car import stop as plant_stop
from tests.support.tables import VEHICLE

DT = 0.005
RUN = made_run()


def test_axle_means_and_signs():
    s = signals(RUN, VEHICLE.rear.rolling_radius)
    assert np.array_equal(s.omega_f, 0.5 * (RUN["omega_fl"] + RUN["omega_fr"]))
    assert np.array_equal(s.omega_r, 0.5 * (RUN["omega_rl"] + RUN["omega_rr"]))
    assert s.z == pytest.approx(-RUN["a_x"] / 9.80665)
    assert s.speed is s.v is RUN["v"]
    assert s.sample_time == pytest.approx(DT)
    assert np.array_equal(s.p_f, RUN["p_mc"])


def test_wheel_pressures_count_where_an_axle_has_both():
    p = RUN["p_mc"]
    all_pressures = changed(RUN, p_fl=0.9 * p, p_fr=0.8 * p, p_rl=0.5 * p, p_rr=0.6 * p)
    s = signals(all_pressures, VEHICLE.rear.rolling_radius)
    assert s.p_f == pytest.approx(0.85 * p)
    assert s.p_r == pytest.approx(0.55 * p)
    front_only = signals(changed(all_pressures, p_rl=None, p_rr=None), VEHICLE.rear.rolling_radius)
    assert front_only.p_f == pytest.approx(0.85 * p)
    assert np.array_equal(front_only.p_r, p)
    left_only = signals(changed(all_pressures, p_fr=None, p_rr=None), VEHICLE.rear.rolling_radius)
    assert np.array_equal(left_only.p_f, p)


def test_speed_without_v_is_that_of_the_rear_wheels():
    s = signals(changed(RUN, v=None), VEHICLE.rear.rolling_radius)
    assert s.v is None
    assert s.speed == pytest.approx(0.322 * s.omega_r)


def test_a_car_that_stands_is_refused():
    with pytest.raises(LogError, match=r"hardly moves: at most 2\.\d m/s"):
        signals(made_run(lambda t: 0.0 * t, speed=2.0), VEHICLE.rear.rolling_radius)


@pytest.mark.parametrize(("rate", "start"), [(40.0, 0.8), (1000.0, 3.0)])
def test_lead_in_ends_just_before_the_brake(start, rate):
    s = signals(made_run(stop(start), rate=rate), VEHICLE.rear.rolling_radius)
    last = s.time[s.lead_in][-1]
    assert start - 0.2 < last <= start
    assert np.all(s.lead_in[s.time <= last])


@pytest.mark.parametrize(("slope", "zero"), [(2e5, 0.8e5), (20e5, 0.0)])
def test_lead_in_ends_where_a_slow_pedal_begins_to_rise(slope, zero):
    """At 2 bar/s it takes 0.75 s to the pressure that counts as braking."""
    run = made_run(lambda t: slope * np.maximum(t - 2.0, 0.0))
    s = signals(changed(run, p_mc=run["p_mc"] + zero), VEHICLE.rear.rolling_radius)
    assert 1.7 < s.time[s.lead_in][-1] <= 2.0


def test_a_driven_or_slow_car_gives_no_zero():
    t = RUN.time
    driven = changed(RUN, a_x=np.where(t < 0.5, 3.0, RUN["a_x"]))
    s = signals(driven, VEHICLE.rear.rolling_radius)
    assert not np.any(s.lead_in[t < 0.5])
    assert np.any(s.lead_in)
    slow = changed(RUN, v=np.where(t < 0.5, 2.0, RUN["v"]))
    assert not np.any(signals(slow, VEHICLE.rear.rolling_radius).lead_in[t < 0.5])


@pytest.mark.parametrize("sign", [-1.0, 1.0])
def test_a_clutch_that_engages_in_the_lead_in_moves_no_zero_of_eta(sign):
    """For 0.2 s the front wheels turn 0.3 % faster or slower: the rest of the lead-in is kept."""
    run = made_run(stop(start=2.0), noise=1.0)
    t = run.time
    is_engaged = (t > 0.8) & (t < 1.0)
    slip = np.where(is_engaged, 1.0 + sign * 3e-3, 1.0)
    slipping = changed(run, **{w: run[w] * slip for w in ("omega_fl", "omega_fr")})
    s, undisturbed = (signals(log, VEHICLE.rear.rolling_radius) for log in (slipping, run))
    assert np.mean(undisturbed.lead_in[(t > 0.3) & (t < 1.7)]) > 0.98  # noise alone takes nothing
    assert not np.any(s.lead_in[is_engaged])
    assert s.lead_in.sum() > 0.7 * undisturbed.lead_in.sum()
    eta, clean = (np.mean((x.omega_r / x.omega_f)[x.lead_in]) for x in (s, undisturbed))
    assert eta == pytest.approx(clean, abs=5e-5)  # 3e-4 and more with it


@pytest.mark.parametrize("felt", [0.0, -1.0])
def test_a_car_under_power_is_no_lead_in(felt):
    """Until 0.45 s before the bite the front wheels drive, by a slip of 0.3 %."""
    run = made_run(stop(start=3.0), noise=1.0)
    power = run.time < 2.55
    driving = {w: np.where(power, 1.003, 1.0) * run[w] for w in ("omega_fl", "omega_fr")}
    driven = changed(run, a_x=np.where(power, run["a_x"] - felt, run["a_x"]), **driving)
    rolling = signals(driven, VEHICLE.rear.rolling_radius).lead_in
    assert not np.any(rolling[run.time < 2.5])
    assert np.count_nonzero(rolling) * run.sample_time > 0.2


TIME = np.arange(0.0, 10.0, DT)


def slowing(bite=0.0):
    """Speed of a wheel that rolls for 3 s at 90 rad/s and is then braked, with a slip ``bite``."""
    slip = bite * np.clip((TIME - 3.0) / 0.3, 0.0, 1.0)
    return (90.0 - 8.0 * np.maximum(TIME - 3.0, 0.0)) * (1.0 - slip)


def angle(omega):
    return np.concatenate([[0.0], np.cumsum(0.5 * (omega[1:] + omega[:-1]) * DT)])


@given(
    st.floats(5e-4, 4e-3),
    st.floats(0.0, 2.0 * np.pi),
    st.sampled_from([1, 2]),
    st.integers(0, 2**31),
)
def test_the_error_of_a_ring_is_removed(size, phase, order, seed):
    omega = slowing(bite=0.02)
    noise = 0.02 * np.random.default_rng(seed).standard_normal(TIME.size)
    read = omega * (1.0 + size * np.cos(order * angle(omega) + phase)) + noise
    residual = (without_runout(read, DT) - noise) / omega - 1.0
    assert np.sqrt(np.mean(residual[TIME < 8.0] ** 2)) < 0.15 * size


@given(st.integers(0, 2**31), st.floats(0.0, 0.03))
def test_a_good_ring_is_left_alone(seed, bite):
    read = slowing(bite) + 0.02 * np.random.default_rng(seed).standard_normal(TIME.size)
    np.testing.assert_array_equal(without_runout(read, DT), read)


def test_wheels_of_the_plant_are_left_alone():
    log = noisy(plant_stop(REAL), 3)
    expected = 0.5 * (log["omega_fl"] + log["omega_fr"])
    np.testing.assert_array_equal(signals(log, CAR.rear.rolling_radius).omega_f, expected)


@pytest.mark.parametrize("seconds", [0.05, 1.0])
def test_a_few_turns_show_no_ring(seconds):
    omega = np.full(round(seconds / DT), 60.0)
    read = omega * (1.0 + 2e-3 * np.cos(angle(omega)))
    np.testing.assert_array_equal(without_runout(read, DT), read)

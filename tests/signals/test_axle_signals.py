"""Signals against numpy, causality by changing the future, noise against its theory."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.signal import lfilter

from calib.errors import LogError
from calib.signals.axle_signals import (
    NOISE_FLOOR,
    blocks,
    lead_in_noise,
    long_run_density,
    sensor_noise,
    signals,
    trailing_mean,
)
from tests.support.made_runs import RADIUS, changed, made_run, stop
from tests.support.tables import VEHICLE

DT = 0.005
floats = st.lists(st.floats(-1e3, 1e3), min_size=1, max_size=60)
RUN = made_run()


# Axle signals ------------------------------------------------------------------------------------


def test_axle_means_and_signs():
    s = signals(RUN, VEHICLE)
    assert np.array_equal(s.omega_f, 0.5 * (RUN["omega_fl"] + RUN["omega_fr"]))
    assert np.array_equal(s.omega_r, 0.5 * (RUN["omega_rl"] + RUN["omega_rr"]))
    assert s.z == pytest.approx(-RUN["a_x"] / 9.80665)
    assert s.speed is s.v is RUN["v"]
    assert s.sample_time == pytest.approx(DT)
    assert np.array_equal(s.p_f, RUN["p_mc"])


def test_wheel_pressures_count_where_an_axle_has_both():
    p = RUN["p_mc"]
    both = changed(RUN, p_fl=0.9 * p, p_fr=0.8 * p, p_rl=0.5 * p, p_rr=0.6 * p)
    s = signals(both, VEHICLE)
    assert s.p_f == pytest.approx(0.85 * p)
    assert s.p_r == pytest.approx(0.55 * p)
    front = signals(changed(both, p_rl=None, p_rr=None), VEHICLE)
    assert front.p_f == pytest.approx(0.85 * p)
    assert np.array_equal(front.p_r, p)
    left = signals(changed(both, p_fr=None, p_rr=None), VEHICLE)
    assert np.array_equal(left.p_f, p)


def test_speed_without_v_is_that_of_the_rear_wheels():
    s = signals(changed(RUN, v=None), VEHICLE)
    assert s.v is None
    assert s.speed == pytest.approx(0.322 * s.omega_r)


def test_a_car_that_stands_is_refused():
    with pytest.raises(LogError, match=r"hardly moves: at most 2\.\d m/s"):
        signals(made_run(lambda t: 0.0 * t, speed=2.0), VEHICLE)


# Lead-in -----------------------------------------------------------------------------------------


@pytest.mark.parametrize("rate", [40.0, 200.0, 1000.0])
@pytest.mark.parametrize("start", [0.8, 3.0])
def test_lead_in_ends_just_before_the_brake(start, rate):
    s = signals(made_run(stop(start), rate=rate), VEHICLE)
    last = s.time[s.lead_in][-1]
    assert start - 0.2 < last <= start
    assert np.all(s.lead_in[s.time <= last])


def test_no_lead_in_after_the_brake_is_released():
    s = signals(made_run(stop(start=2.0, end=4.0)), VEHICLE)
    assert not np.any(s.lead_in[s.time > 2.0])


def test_all_of_a_coast_is_lead_in_while_the_car_moves():
    s = signals(made_run(lambda t: 0.0 * t), VEHICLE)
    assert np.all(s.lead_in)


def test_a_driven_or_slow_car_gives_no_zero():
    t = RUN.time
    driven = changed(RUN, a_x=np.where(t < 0.5, 3.0, RUN["a_x"]))
    s = signals(driven, VEHICLE)
    assert not np.any(s.lead_in[t < 0.5])
    assert np.any(s.lead_in)
    slow = changed(RUN, v=np.where(t < 0.5, 2.0, RUN["v"]))
    assert not np.any(signals(slow, VEHICLE).lead_in[t < 0.5])


# Means -------------------------------------------------------------------------------------------


@given(floats, st.integers(1, 20))
def test_trailing_mean_is_the_plain_one(x, n):
    expected = [np.mean(x[max(0, i + 1 - n) : i + 1]) for i in range(len(x))]
    assert trailing_mean(np.array(x), n) == pytest.approx(expected, abs=1e-9)


@given(floats, floats, st.integers(1, 20))
def test_trailing_mean_knows_nothing_of_the_future(past, future, n):
    short = trailing_mean(np.array(past), n)
    assert np.array_equal(trailing_mean(np.array(past + future), n)[: len(past)], short)


@pytest.mark.parametrize(("rate", "samples"), [(40.0, 2), (200.0, 10), (1000.0, 50)])
def test_block_means_are_numpys(rate, samples):
    log = made_run(rate=rate, duration=8.0 + 0.03)
    s = signals(log, VEHICLE)
    b = blocks(s)
    assert (b.samples, b.length) == (samples, pytest.approx(0.05))
    assert b.end.size == log.time.size // samples
    for name in ("p_f", "p_r", "z", "omega_f", "omega_r", "v", "speed"):
        parts = np.split(getattr(s, name)[: samples * b.end.size], b.end.size)
        assert getattr(b, name) == pytest.approx([np.mean(part) for part in parts])
    assert b.end == pytest.approx(s.time[samples - 1 :: samples][: b.end.size])
    assert b.spin_f[1:] == pytest.approx(np.diff(b.omega_f) / 0.05)
    assert b.eta == pytest.approx(b.omega_r / b.omega_f)
    assert np.array_equal(b.lead_in, np.isin(b.end, s.time[s.lead_in]))


@settings(max_examples=30)
@given(st.integers(400, 1600), st.integers(0, 2**31))
def test_a_block_knows_nothing_of_the_future(cut, seed):
    """What comes after ``cut`` drawn anew: no block that is complete by then changes."""
    rng = np.random.default_rng(seed)
    other = {
        name: np.where(np.arange(x.size) < cut, x, x * rng.uniform(0.5, 1.5, x.size))
        for name, x in RUN.channels.items()
        if name != "time"
    }
    before, after = (blocks(signals(log, VEHICLE)) for log in (RUN, changed(RUN, **other)))
    known = cut // before.samples
    for name in ("end", "p_f", "z", "omega_f", "omega_r", "v", "speed", "spin_f", "spin_r"):
        assert np.array_equal(getattr(before, name)[:known], getattr(after, name)[:known])


# Noise -------------------------------------------------------------------------------------------


def coloured(rng, n, share, tau=0.1):
    """White noise and an AR(1) of time constant ``tau`` [s], unit variance together."""
    a = np.exp(-DT / tau)
    slow = lfilter([np.sqrt(1.0 - a * a)], [1.0, -a], rng.normal(size=n + 2000))[2000:]
    return np.sqrt(1.0 - share) * rng.normal(size=n) + np.sqrt(share) * slow


def theory(share, tau=0.1):
    """Square root of the spectrum at no frequency: the sum of all covariances times the step."""
    a = np.exp(-DT / tau)
    return np.sqrt(DT * (1.0 - share + share * (1.0 + a) / (1.0 - a)))


@pytest.mark.parametrize(
    ("share", "window", "reads"),
    [(0.0, 4.0, 1.0), (0.45, 4.0, 0.9), (1.0, 4.0, 0.9), (0.0, 2.0, 0.95), (0.45, 2.0, 0.7)],
)
@pytest.mark.parametrize("seconds", [8, 60])
def test_density_is_that_of_theory_as_far_as_it_says(share, window, reads, seconds):
    """Mean of 60 runs; a slow drift and a companion are in the way and are taken out."""
    rng = np.random.default_rng(seconds)
    t = 0.05 * np.arange(20 * seconds)
    companion = np.sin(5.0 * t) + np.sin(t / 3.0)
    found = []
    for _ in range(60):
        x = coloured(rng, 200 * seconds, share).reshape(-1, 10).mean(axis=1)
        found.append(long_run_density(x + 0.1 * t + 3.0 * companion, 0.05, companion, window))
    assert np.mean(found) == pytest.approx(reads * theory(share), rel=0.1)


@pytest.mark.parametrize("bite", [3.0, 30.0, 3e3])
def test_a_brake_that_bites_in_one_window_is_hardly_noise(bite):
    """It is out of the variance, and r stays below 0.8: at most sqrt(1.8/0.2) = 3 times."""
    x = np.random.default_rng(3).normal(size=600)
    x[210:] -= bite
    assert 0.75 < long_run_density(x, 0.05) / np.sqrt(0.05) < 3.0 * 1.25


def test_a_short_run_is_read_as_white():
    x = np.random.default_rng(2).normal(size=24)
    assert long_run_density(x, 0.05) == pytest.approx(np.std(x) * np.sqrt(0.05))
    assert long_run_density(np.zeros(200), 0.05) == 0.0


def test_noise_of_a_made_run_is_what_was_put_in():
    """Sd 0.02 rad/s a wheel, 0.05 m/s^2, 0.02 m/s, all white."""
    log = made_run(duration=40.0, speed=60.0, pressure=lambda t: np.minimum(0.7 * t, 9.0))
    noise = sensor_noise(log, blocks(signals(log, VEHICLE)))
    assert noise.omega_white == pytest.approx(0.02 / np.sqrt(2.0), rel=0.05)
    # 40 s tell a density to 8 %
    assert noise.omega == pytest.approx(0.02 / np.sqrt(2.0) * np.sqrt(DT), rel=0.24)
    assert noise.z == pytest.approx(0.05 / 9.80665 * np.sqrt(DT), rel=0.24)
    assert noise.v == pytest.approx(np.hypot(0.02, 0.02 * RADIUS / 1.4) * np.sqrt(DT), rel=0.24)


def test_no_sensor_is_believed_to_be_without_noise():
    log = made_run(noise=0.0)
    noise = sensor_noise(log, blocks(signals(log, VEHICLE)))
    assert noise.omega == NOISE_FLOOR["omega"]
    without = changed(made_run(), v=None)
    assert sensor_noise(without, blocks(signals(without, VEHICLE))).v == NOISE_FLOOR["v"]


def test_lead_in_noise_is_the_white_part_with_a_usual_colour_and_nothing_later():
    log = made_run(stop(start=4.0))
    s = signals(log, VEHICLE)
    noise = lead_in_noise(log, s)
    assert noise.omega_white == pytest.approx(0.02 / np.sqrt(2.0), rel=0.1)
    assert noise.omega == pytest.approx(1.5 * 0.02 / np.sqrt(2.0) * np.sqrt(DT), rel=0.1)
    assert noise.z == pytest.approx(2.0 * 0.05 / 9.80665 * np.sqrt(DT), rel=0.1)
    assert noise.v == pytest.approx(0.02 * np.sqrt(DT), rel=0.1)
    rough = changed(log, omega_fl=np.where(log.time > 4.0, 1.1, 1.0) * log["omega_fl"])
    assert lead_in_noise(rough, signals(rough, VEHICLE)) == noise

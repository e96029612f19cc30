"""Noise of sensors, and of a zero that ages, against their theory."""

import numpy as np
import pytest
from scipy.signal import lfilter

from calib.run.axle_signals import signals
from calib.run.blocks import blocks
from calib.run.noise import WALK, _long_run_density, lead_in_noise, sensor_noise, sigma_growth
from tests.support.made_runs import RADIUS, changed, made_run, stop
from tests.support.tables import VEHICLE

DT = 0.005


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
def test_density_is_that_of_theory_with_the_documented_bias(share, window, reads):
    """Mean of 60 runs; a slow drift and a companion are in the way and are taken out."""
    seconds, rng = 8, np.random.default_rng(8)
    t = 0.05 * np.arange(20 * seconds)
    companion = np.sin(5.0 * t) + np.sin(t / 3.0)
    densities = []
    for _ in range(60):
        x = coloured(rng, 200 * seconds, share).reshape(-1, 10).mean(axis=1)
        densities.append(_long_run_density(x + 0.1 * t + 3.0 * companion, 0.05, companion, window))
    assert np.mean(densities) == pytest.approx(reads * theory(share), rel=0.1)


@pytest.mark.parametrize("bite", [3.0, 3e3])
def test_a_brake_that_bites_in_one_window_is_hardly_noise(bite):
    """It is out of the variance, and r stays below 0.8: at most sqrt(1.8/0.2) = 3 times."""
    x = np.random.default_rng(3).normal(size=600)
    x[210:] -= bite
    assert 0.75 < _long_run_density(x, 0.05) / np.sqrt(0.05) < 3.0 * 1.25


def test_noise_of_a_made_run_is_what_was_put_in():
    """Sd 0.02 rad/s a wheel, 0.05 m/s^2, 0.02 m/s, all white."""
    log = made_run(duration=40.0, speed=60.0, pressure=lambda t: np.minimum(0.7 * t, 9.0))
    noise = sensor_noise(log, blocks(signals(log, VEHICLE.rear.rolling_radius)))
    assert noise.omega_white == pytest.approx(0.02 / np.sqrt(2.0), rel=0.05)
    # 40 s tell a density to 8 %
    assert noise.omega == pytest.approx(0.02 / np.sqrt(2.0) * np.sqrt(DT), rel=0.24)
    assert noise.z == pytest.approx(0.05 / 9.80665 * np.sqrt(DT), rel=0.24)
    assert noise.v == pytest.approx(np.hypot(0.02, 0.02 * RADIUS / 1.4) * np.sqrt(DT), rel=0.24)


def test_no_sensor_is_believed_to_be_without_noise():
    log = made_run(noise=0.0)
    noise = sensor_noise(log, blocks(signals(log, VEHICLE.rear.rolling_radius)))
    assert noise.omega == 3e-4
    without = changed(made_run(), v=None)
    assert sensor_noise(without, blocks(signals(without, VEHICLE.rear.rolling_radius))).v == 3e-4


def test_lead_in_noise_is_the_white_part_with_a_usual_colour_and_nothing_later():
    log = made_run(stop(start=4.0))
    s = signals(log, VEHICLE.rear.rolling_radius)
    noise = lead_in_noise(log, s)
    assert noise.omega_white == pytest.approx(0.02 / np.sqrt(2.0), rel=0.1)
    assert noise.omega == pytest.approx(1.5 * 0.02 / np.sqrt(2.0) * np.sqrt(DT), rel=0.1)
    assert noise.z == pytest.approx(2.0 * 0.05 / 9.80665 * np.sqrt(DT), rel=0.1)
    assert noise.v == pytest.approx(0.02 * np.sqrt(DT), rel=0.1)
    rough = changed(log, omega_fl=np.where(log.time > 4.0, 1.1, 1.0) * log["omega_fl"])
    assert lead_in_noise(rough, signals(rough, VEHICLE.rear.rolling_radius)) == noise


STEP = 0.05


def weights(density, duration):
    time = STEP * np.arange(round(duration / STEP))
    factor = sigma_growth(time, np.ones(time.size, bool), np.full(time.size, density))
    return factor**-2.0


def variance(w, density):
    """Variance of the weighed mean about the last value, by white noise and the walk since then."""
    share = w / w.sum()
    noise = density**2 / STEP * share @ share
    older = np.cumsum(share)[:-1]  # weight of the samples before each step of the walk
    return noise + WALK**2 * STEP * older @ older


@pytest.mark.parametrize("duration", [40.0, 300.0])
def test_the_variance_is_that_of_the_steady_kalman_filter(duration):
    density = 5e-5
    w = weights(density, duration)
    claimed = density**2 / STEP / w.sum()
    assert variance(w, density) == pytest.approx(density * WALK, rel=0.05)
    assert claimed == pytest.approx(density * WALK, rel=0.05)
    assert variance(w, density) < variance(np.ones(w.size), density)


def test_outside_the_lead_in_sigma_does_not_grow():
    assert weights(1e-3, 1.0).min() > 0.9  # much shorter than it lasts: tau is 80 s
    time, rolling = np.arange(4.0), np.array([True, True, False, False])
    factor = sigma_growth(time, rolling, np.full(4, WALK))
    assert factor == pytest.approx([np.exp(0.5), 1.0, 1.0, 1.0])
    assert sigma_growth(time, np.zeros(4, bool), np.full(4, WALK)) == pytest.approx(np.ones(4))

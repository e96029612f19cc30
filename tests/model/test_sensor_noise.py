"""Sensor noise against the law that it is drawn from."""

import numpy as np
import pytest

from calib.logs.log import Log
from calib.model.sensor_noise import NoiseLevel, add_noise, reading

N, DT = 200_000, 0.005


def noise(level, dt=DT):
    return reading(np.zeros(N), level, dt, np.random.default_rng(1))


def made_log(**more):
    time = np.arange(2000) * DT
    channels = {"time": time, "a_x": -3.0 + 0.0 * time, "omega_fl": 80.0 - time, **more}
    return Log("made", "test", "d", channels, truth={"true_Tb_fl": time}, notes=("first",))


@pytest.mark.parametrize("coloured", [0.0, 0.45, 1.0])
def test_variance_and_correlation_are_those_of_the_law(coloured):
    """r(k) = c a^k for k > 0; a sample of N has sd sqrt(2 tau/(N dt)) in r, five of it allowed."""
    x = noise(NoiseLevel(0.05, coloured), dt=0.001)
    a = np.exp(-0.001 / 0.1)
    scatter = np.sqrt((1.0 + a * a) / (1.0 - a * a) / N) if coloured else 1.0 / np.sqrt(N)
    assert np.var(x) == pytest.approx(0.05**2, rel=5.0 * np.sqrt(2.0) * scatter)
    for lag in (1, 5, 20):
        r = np.mean(x[lag:] * x[:-lag]) / np.var(x)
        assert r == pytest.approx(coloured * a**lag, abs=5.0 * scatter)


def test_rounding_adds_a_twelfth_of_its_step_squared():
    x = noise(NoiseLevel(0.1, 0.0, 0.1))
    assert x / 0.1 == pytest.approx(np.round(x / 0.1), abs=1e-9)
    assert np.var(x) == pytest.approx(0.1**2 + 0.1**2 / 12.0, rel=5.0 * np.sqrt(2.0 / N))


def test_same_seed_same_noise_and_every_channel_its_own():
    log = made_log(omega_fr=80.0 - np.arange(2000) * DT)
    once, again, other = add_noise(log, 3), add_noise(log, 3), add_noise(log, 4)
    assert np.array_equal(once["a_x"], again["a_x"])
    assert once.digest == again.digest != other.digest
    assert not np.array_equal(once["a_x"], other["a_x"])
    assert not np.array_equal(once["omega_fl"], once["omega_fr"])
    more = add_noise(made_log(v=np.full(2000, 20.0)), 3)
    assert np.array_equal(add_noise(made_log(), 3)["a_x"], more["a_x"])

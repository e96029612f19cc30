"""The gap of replays that are off by a known size, and where it is, on logs with known noise."""

import numpy as np
import pytest

from calib.diagnosis.replays import CHANNELS, gap_of, noises_of
from calib.logs.log import Log
from calib.model.sensor_noise import add_noise
from calib.run.copies import without_holds
from tests.support.measuring_chain import Message, chained

NOISE = 0.02
TIME = np.arange(0.0, 40.0, 0.005)
SMOOTH = np.sin(0.5 * TIME)
OFF = {"near": (0.5, 0.1), "far": (2.0, 3.0)}
"""Errors of the replays of two logs, before and after, in every channel."""


def log_of(signal: np.ndarray, name: str = "log", noise: float = 0.0, seed: int = 0) -> Log:
    """A log with a signal in every channel, each with white noise of its own."""
    rng, size = np.random.default_rng(seed), TIME.size
    channels = {channel: signal + noise * rng.standard_normal(size) for channel in CHANNELS}
    return Log(name, "", "", {"time": TIME, **channels})


@pytest.fixture(scope="module")
def gap():
    measured, replays_before, replays_after = [], [], []
    for seed, (name, (first, last)) in enumerate(OFF.items()):
        measured.append(log_of(SMOOTH, name, NOISE, seed))
        replays_before.append(log_of(SMOOTH + first))
        replays_after.append(log_of(SMOOTH + last))
    return gap_of(replays_before, replays_after, measured)


def test_every_log_and_channel_has_its_own_gap(gap):
    assert gap.logs == tuple(OFF)
    assert gap.noise == pytest.approx(NOISE, rel=0.1)
    for log, (error_before, error_after) in OFF.items():
        for channel, noise in zip(CHANNELS, gap.noise, strict=True):
            first, last = gap.rms(log, channel)
            assert noise * first == pytest.approx(error_before, rel=0.01)
            assert noise * last == pytest.approx(error_after, rel=0.02)
        cells = np.array([gap.rms(log, channel) for channel in CHANNELS])
        assert gap.rms(log) == pytest.approx(np.sqrt(np.mean(cells**2, axis=0)))


def test_the_gap_of_all_is_the_rms_of_logs_and_channels(gap):
    cells = np.array([gap.rms(log, channel) for log in gap.logs for channel in CHANNELS])
    assert gap.rms() == pytest.approx(np.sqrt(np.mean(cells**2, axis=0)))
    assert gap.closed < 0.0  # the far log got worse by more than the near one got better


def test_noise_that_is_slow_in_part_counts_as_it_is():
    """The coloured part of `add_noise`, 0.45 of the variance of a_x, as on a road."""
    smooth = log_of(0.0 * TIME)
    noises = [noises_of([add_noise(smooth, 4 * k + i) for i in range(4)])[0] for k in range(10)]
    assert np.mean(noises) == pytest.approx(0.055, rel=0.08)
    assert np.std(noises) < 0.1 * 0.055


def test_a_ripple_is_no_noise():
    """Ten times a second, five times the noise: at most root two of the noise."""
    log = log_of(0.1 * np.sin(20.0 * np.pi * TIME), noise=NOISE)
    assert np.all(noises_of([log]) < 1.5 * NOISE)


def test_the_noise_of_a_channel_is_that_of_its_values_however_seldom_they_are_sent():
    log = log_of(SMOOTH, noise=NOISE)
    sent = without_holds(chained(log, {"v": Message(20.0)}, np.random.default_rng(1)))
    # between two values noise is averaged: to two thirds of its variance, on the mean
    noises = dict(zip(CHANNELS, noises_of([sent]), strict=True))
    assert noises["v"] == pytest.approx(np.sqrt(2.0 / 3.0) * NOISE, rel=0.2)
    assert noises["a_x"] == pytest.approx(NOISE, rel=0.1)

"""The gap of replays that are off by a known size, and where it is, on logs with known noise."""

from dataclasses import replace

import numpy as np
import pytest

from calib.diagnosis.replays import CHANNELS, gap_of, noises_of
from calib.logs.log import Log
from calib.model.sensor_noise import add_noise
from calib.run.copies import without_holds
from tests.support.measuring_chain import Message, chained

NOISE = 0.02
OFF = {"near": (0.5, 0.1), "far": (2.0, 3.0)}
"""Errors of the replays of two logs, before and after, in every channel."""


@pytest.fixture(scope="module")
def gap():
    chance = np.random.default_rng(1)
    measured, replays_before, replays_after = [], [], []
    for name, (first, last) in OFF.items():
        time = np.arange(0.0, 20.0, 0.005)
        smooth = {c: np.sin(0.5 * time) for c in CHANNELS}
        noisy = {c: x + chance.normal(0.0, NOISE, time.size) for c, x in smooth.items()}
        log = Log(name, "", "", {"time": time, **noisy})
        measured.append(log)
        for logs, error in ((replays_before, first), (replays_after, last)):
            wrong = {c: x + error for c, x in smooth.items()}
            logs.append(replace(log, channels={"time": time} | wrong))
    return gap_of(replays_before, replays_after, measured)


def test_every_log_and_channel_has_its_own_gap(gap):
    assert gap.logs == tuple(OFF)
    assert gap.noise == pytest.approx(NOISE, rel=0.1)
    for log, (error_before, error_after) in OFF.items():
        for channel, noise in zip(CHANNELS, gap.noise, strict=True):
            first, last = gap.rms(log, channel)
            assert noise * first == pytest.approx(error_before, rel=0.01)
            assert noise * last == pytest.approx(error_after, rel=0.02)


def test_the_gap_of_all_is_the_rms_of_logs_and_channels(gap):
    cells = np.array([gap.rms(log, channel) for log in gap.logs for channel in CHANNELS])
    assert gap.rms() == pytest.approx(np.sqrt(np.mean(cells**2, axis=0)))
    assert gap.closed < 0.0  # the far log got worse by more than the near one got better


def test_noise_that_is_slow_in_part_counts_as_it_is():
    """The coloured part of `add_noise`, 0.45 of the variance of a_x, as on a road."""
    time = np.arange(0.0, 20.0, 0.005)
    smooth = Log("road", "", "", {"time": time} | dict.fromkeys(CHANNELS, 0.0 * time))
    noises = [noises_of([add_noise(smooth, 4 * k + i) for i in range(4)])[0] for k in range(10)]
    assert np.mean(noises) == pytest.approx(0.055, rel=0.08)
    assert np.std(noises) < 0.1 * 0.055


def test_a_ripple_is_no_noise():
    """Ten times a second, five times the noise: at most root two of the noise."""
    time = np.arange(0.0, 20.0, 0.005)
    smooth = 0.1 * np.sin(20.0 * np.pi * time)
    noise = np.random.default_rng(2).normal(0.0, NOISE, time.size)
    log = Log("ripple", "", "", {"time": time} | dict.fromkeys(CHANNELS, smooth + noise))
    assert np.all(noises_of([log]) < 1.5 * NOISE)


def test_the_noise_of_a_channel_is_that_of_its_values_however_seldom_they_are_sent():
    time = np.arange(0.0, 40.0, 0.005)
    smooth = {c: np.sin(0.5 * time) for c in CHANNELS}
    rng = np.random.default_rng(1)
    noisy = {c: x + rng.normal(0.0, NOISE, time.size) for c, x in smooth.items()}
    log = Log("bus", "", "", {"time": time} | noisy)
    sent = without_holds(chained(log, {"v": Message(20.0)}, rng))
    # between two values noise is averaged: to two thirds of its variance, on the mean
    noises = dict(zip(CHANNELS, noises_of([sent]), strict=True))
    assert noises["v"] == pytest.approx(np.sqrt(2.0 / 3.0) * NOISE, rel=0.2)
    assert noises["a_x"] == pytest.approx(NOISE, rel=0.1)

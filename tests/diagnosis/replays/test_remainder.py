"""What is left in replays, on errors of known size: noise is none, a lasting error is."""

from dataclasses import replace

import numpy as np
import pytest

from calib.diagnosis.replays.remainder import BLOCK, LEAST, remainder_of
from calib.logs.log import Log
from tests.support.made_runs import changed, made_run

SD_V = 0.02
"""Noise of v of the made runs, white: the gap counts it as it is."""


def runs(seed: int) -> tuple[Log, Log]:
    """A replay without noise and the log with it."""
    clean = made_run(noise=0.0)
    rng = np.random.default_rng(seed)
    sds = {"a_x": 0.05, "v": 0.02, **{f"omega_{w}": 0.02 for w in ("fl", "fr", "rl", "rr")}}
    n = clean.time.size
    return clean, changed(clean, **{c: clean[c] + rng.normal(size=n) * s for c, s in sds.items()})


def stay() -> list[list[Log]]:
    return []


def test_noise_alone_leaves_nothing():
    clean, log = runs(1)
    left = remainder_of([clean], [log], stay)
    assert not left.significant
    assert left.size < 0.1


def test_noise_that_is_correlated_over_a_tenth_of_a_second_leaves_nothing():
    clean, log = runs(2)
    rng, slow = np.random.default_rng(3), np.zeros(clean.time.size)
    for k in range(1, slow.size):  # sd 0.06, time constant 0.1 s
        slow[k] = 0.95 * slow[k - 1] + 0.06 * np.sqrt(1 - 0.95**2) * rng.normal()
    left = remainder_of([clean], [changed(log, a_x=log["a_x"] + slow)], stay)
    assert not left.significant


def test_a_drift_has_its_size_channel_and_place():
    clean, log = runs(4)
    drift = 1.0 * np.clip((clean.time - 4.0) / 2.0, 0.0, 1.0)  # m/s, from 4 s to 6 s
    left = remainder_of([changed(clean, v=clean["v"] + drift)], [log], stay)
    assert left.significant
    assert left.channel == "v"
    expected = np.sqrt(np.mean(drift**2)) / SD_V
    assert left.largest == pytest.approx(expected, rel=0.1)
    assert left.size == pytest.approx(expected / np.sqrt(6.0), rel=0.1)
    assert 3.5 <= left.time[0] < left.time[1] <= 6.5


def test_what_the_error_of_a_parameter_can_do_is_not_left():
    clean, log = runs(6)
    drift = 0.05 * clean.time
    off, step = changed(clean, v=clean["v"] + drift), changed(clean, v=clean["v"] + 1.5 * drift)
    assert remainder_of([off], [log], stay).size > LEAST
    assert not remainder_of([off], [log], lambda: [[step]]).significant  # two steps back
    far = changed(clean, v=clean["v"] + 1.05 * drift)  # twenty steps back: too many
    assert remainder_of([off], [log], lambda: [[far]]).significant


def test_a_ripple_that_turns_several_times_in_a_block_is_not_lasting():
    clean, log = runs(5)
    ripple = 0.5 * np.sin(2.0 * np.pi * 5.0 / BLOCK * clean.time)
    assert not remainder_of([changed(clean, a_x=clean["a_x"] + ripple)], [log], stay).significant


def test_a_replay_that_ends_early_is_judged_as_far_as_it_goes():
    clean, log = runs(7)
    n = clean.time.size // 2
    half = replace(clean, channels={k: x[:n] for k, x in clean.channels.items()})
    assert not remainder_of([half], [log], stay).significant

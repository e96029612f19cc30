"""What is left in replays, on errors of known size."""

from dataclasses import replace

import numpy as np
import pytest

from calib.diagnosis.replays.gap import Remainder, gap_of, remainder_of
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


def left_by(replay: Log, log: Log) -> Remainder:
    """What one replay leaves of its log."""
    return remainder_of(gap_of([replay], [replay], [log]), [replay], [log])


def test_noise_alone_leaves_nothing():
    clean, log = runs(1)
    assert left_by(clean, log).size < 0.2


def test_a_drift_has_its_size_channel_and_place():
    clean, log = runs(4)
    drift = 1.0 * np.clip((clean.time - 4.0) / 2.0, 0.0, 1.0)  # m/s, from 4 s to 6 s
    left = left_by(changed(clean, v=clean["v"] + drift), log)
    assert (left.log, left.channel) == (log.name, "v")
    expected = np.sqrt(np.mean(drift**2)) / SD_V
    assert left.largest == pytest.approx(expected, rel=0.1)
    assert left.size == pytest.approx(expected / np.sqrt(6.0), rel=0.1)
    assert 3.5 <= left.time[0] < left.time[1] <= 6.5


def test_a_replay_that_ends_early_is_judged_as_far_as_it_goes():
    clean, log = runs(7)
    n = clean.time.size // 2
    half = replace(clean, channels={k: x[:n] for k, x in clean.channels.items()})
    assert left_by(half, log).size < 0.2
